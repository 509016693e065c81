#include "apps/robot/console.hpp"

#include <cstdio>
#include <exception>

#include "apps/robot/session_report.hpp"
#include "apps/robot/status_view.hpp"
#include "common/patient_output.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr Duration kRedraw = std::chrono::milliseconds(200);

}  // namespace

void say_robot(const std::string& line) {
  patient_stderr().say("robot: " + line + "\n");
}

Console::Console(const Rig& rig, const RobotDevices& devices, Robot& robot, RobotCameras* cameras,
                 const ConsoleOptions& options)
    : rig_(rig),
      devices_(devices),
      robot_(robot),
      cameras_(cameras),
      report_(options.session),
      faults_(parse_mock_faults(options.faults, rig, options.mock), rig, devices),
      // The keyboard can always stop and quit; it drives only where no file does.
      keys_(rig.gate_options().joints,
            options.follow.empty() ? KeyOperator::Rights::drives : KeyOperator::Rights::only_stops),
      line_(options.line),
      line_news_(options.line_news),
      line_stopper_(options.line_stopper),
      give_control_(options.give_control),
      news_(rig.joint_words()) {
  if (!options.follow.empty()) {
    follow_.emplace(FollowFile(options.follow, rig), options.may_home);
    commanders_.push_back(&*follow_);
    news_.name(follow_->operator_id(), "the file");
    for (const std::string& words : words_on_start(follow_->file())) say_robot("follow: " + words);
  }
  if (keyboard_.is_terminal()) commanders_.push_back(&keys_);
  if (options.commander) {
    commanders_.push_back(options.commander);
    news_.name(options.commander->operator_id(), "an operator over the line");
  }
  if (!options.joints.empty()) joints_.emplace(options.joints, rig, robot.cycles());
  if (!options.session.empty()) session_.emplace(rig, robot.cycles());
  if (keyboard_.is_terminal()) say_robot(KeyOperator::help());
}

bool Console::tick(RobotTime now) {
  for (const std::string& line : faults_.step(now)) say_robot(line);
  if (const std::string news = line_news_ ? line_news_(now) : ""; !news.empty()) say_robot("line: " + news);
  take_keys(now);
  const bool goes_on = serve(commanders_, robot_, now);
  const RobotStatus status = robot_.status();
  if (joints_) joints_->write();
  if (session_) session_->write(devices_.buses());
  if (const std::string fault = cameras_ && !told_of_recording_ ? cameras_->recording_fault() : ""; !fault.empty()) {
    say_robot("recording has ended: " + fault);
    told_of_recording_ = true;
  }
  if (!keyboard_.is_terminal())  // else the view shows it
    if (const std::string news = news_.of(status, std::chrono::system_clock::now(), line_stopper()); !news.empty())
      say_robot(news);
  show(now, status);
  notify(now, status);
  return goes_on;
}

void Console::take_keys(RobotTime now) {
  const std::string keys = keyboard_.pressed();
  if (give_control_ && keys.find('g') != std::string::npos) give_control_(now);
  keys_.press(keys);
}

std::string Console::trouble() const {
  return !follow_ || follow_->succeeded() ? "" : "The motion of the file: " + outcome() + ".";
}

int Console::finish() {
  const std::string recording = finish_recording();  // the first: nothing else may cost it
  if (joints_ && joints_->dropped() > 0)
    say_robot(std::to_string(joints_->dropped()) +
              " cycles are missing in the joints' file: this program came too late, or a joint was silent");
  for (const std::string& line : faults_.missed()) say_robot(line);
  for (const std::filesystem::path& log : devices_.logs()) say_robot("log: " + log.string());
  if (follow_) say_robot("follow: " + outcome());
  bool well = !follow_ || follow_->succeeded();
  for (const std::string& fault : {recording, log_fault()}) {
    if (fault.empty()) continue;
    patient_stderr().say("foresight: " + fault + "\n");
    well = false;
  }
  if (session_) report();
  const std::string last = view(robot_.status(), -1);
  keyboard_.is_terminal() ? patient_stdout().show(last) : static_cast<void>(std::fputs(last.c_str(), stdout));
  return well ? 0 : 1;
}

/// "", or what it lacks.
std::string Console::finish_recording() {
  if (!cameras_) return "";
  try {
    if (const std::string recorded = cameras_->finish(); !recorded.empty()) say_robot(recorded);
    return cameras_->recording_fault();
  } catch (const std::exception& error) {
    return error.what();
  }
}

std::string Console::outcome() const {
  return follow_->outcome().empty() ? "interrupted" : follow_->outcome();
}

/// "" where all logs are complete.
std::string Console::log_fault() {
  const std::string fault = joints_ ? joints_->fault() : "";
  return fault.empty() ? devices_.log_fault() : fault;
}

std::string Console::view(const RobotStatus& status, int selected) const {
  std::string out = status_text(rig_, status, devices_.buses(), selected, line_stopper());
  if (cameras_) out += camera_text(cameras_->watch().line());
  if (const std::string fault = cameras_ ? cameras_->registration_trouble() : ""; !fault.empty())
    out += "  poses: " + fault + "\n";
  if (const std::string fault = cameras_ ? cameras_->recording_fault() : ""; !fault.empty())
    out += "  recording: ended: " + fault + "\n";
  if (line_) out += "line: " + line_() + "\n";
  return out;
}

void Console::report() {
  session_->write(devices_.buses());
  const RobotStatus status = robot_.status();
  std::vector<SessionFact> facts{
      {"duration", readable(session_->duration_s(), 2, " s")},
      {"commands",
       std::to_string(status.gate.accepted) + " followed, " + std::to_string(status.gate.dropped) + " dropped"},
      {"control loop", std::to_string(status.loop.cycles()) + " cycles, " + std::to_string(status.loop.overruns()) +
                           " overruns, lateness p99 " +
                           readable(1e3 * to_seconds(status.loop.quantile(0.99)), 3, " ms")},
      {"cycles that this page lacks", std::to_string(session_->dropped())}};
  for (const std::filesystem::path& log : devices_.logs()) facts.push_back({"CAN log", log.string()});
  write_session_report(report_, rig_, *session_,
                       follow_ ? "The motion of the file: " + outcome() + "." : "Driven by hand.", facts);
  say_robot("session: " + report_.string());
}

void Console::show(RobotTime now, const RobotStatus& status) {
  if (!keyboard_.is_terminal() || now - shown_ < kRedraw) return;
  shown_ = now;
  std::string text = view(status, follow_ ? -1 : static_cast<int>(keys_.selected()));
  text += std::string("\n") + KeyOperator::help() + "\n";
  if (keys_.asks_for_consent()) text += "Every joint will look for home, slowly. Is the robot's way clear? y/n\n";
  patient_stdout().show("\x1b[H\x1b[J" + text);
}

void Console::notify(RobotTime now, const RobotStatus& status) {
  const auto period = service_watchdog_period();
  if (!period || now - notified_ < *period / 2) return;
  if (life_.goes_on(now, status)) notify_service("WATCHDOG=1");
  notified_ = now;
}

}  // namespace foresight
