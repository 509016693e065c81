#include "apps/robot_command.hpp"

#include <atomic>
#include <cstdio>
#include <future>
#include <thread>

#include "apps/live_view.hpp"
#include "apps/recording_outputs.hpp"
#include "apps/rig_feed.hpp"
#include "apps/robot/keyboard.hpp"
#include "apps/robot/service_notify.hpp"
#include "apps/robot/session_report.hpp"
#include "apps/robot/status_view.hpp"
#include "apps/run_options.hpp"
#include "common/error.hpp"
#include "common/real_time.hpp"
#include "common/stop_signal.hpp"
#include "common/text.hpp"
#include "operators/follow_operator.hpp"
#include "operators/key_operator.hpp"
#include "rig/mock_faults.hpp"
#include "session/joint_log.hpp"
#include "session/robot_cameras.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kTick = 10ms;
constexpr Duration kRedraw = 200ms;
constexpr int kPriority = 80;  // above the network's and the cameras' threads, below the kernel's watchdogs

struct Arguments {
  std::string rig;
  std::string follow;
  std::string log, record, session;
  bool cameras = true;
  bool mock = false, stepped = false, may_home = false, check_only = false;
  bool rig_view = false;
  bool view = false, window = false;  // the rest only with `view`
  std::optional<double> delay_ms;
  std::string scene;
  ViewOutputs outputs;
  std::vector<std::string> faults;
};

void say(const std::string& line) {
  std::fprintf(stderr, "robot: %s\n", line.c_str());
}

/// What goes on beside the control loop: operators, the view, the service's watchdog.
class Console {
 public:
  /// `cameras`: may be null.
  Console(const Rig& rig, const RobotDevices& devices, Robot& robot, RobotCameras* cameras, const Arguments& arguments)
      : rig_(rig),
        devices_(devices),
        robot_(robot),
        cameras_(cameras),
        faults_(parse_mock_faults(arguments.faults, rig, arguments.mock), rig, devices),
        // The keyboard can always stop and quit; it drives only where no file does.
        keys_(rig.gate_options().joints,
              arguments.follow.empty() ? KeyOperator::Rights::drives : KeyOperator::Rights::only_stops) {
    if (!arguments.follow.empty()) {
      follow_.emplace(FollowFile(arguments.follow, rig), arguments.may_home);
      commanders_.push_back(&*follow_);
    }
    if (keyboard_.is_terminal()) commanders_.push_back(&keys_);
    if (!arguments.record.empty()) joints_.emplace(joint_log_beside(arguments.record), rig, robot.cycles());
    if (!arguments.session.empty()) session_.emplace(rig, robot.cycles());
    report_ = arguments.session;
    if (keyboard_.is_terminal()) say(KeyOperator::help());
  }

  /// False: the program shall end.
  bool tick(RobotTime now) {
    for (const std::string& line : faults_.step(now)) say(line);
    keys_.press(keyboard_.pressed());
    const bool goes_on = serve(commanders_, robot_, now);
    const RobotStatus status = robot_.status();
    if (joints_) joints_->write();
    if (session_) session_->write(devices_.buses());
    show(now, status);
    notify(now, status);
    return goes_on;
  }

  /// How the motion of the file ended, where it did not end well.
  std::string trouble() const {
    return !follow_ || follow_->succeeded() ? "" : "The motion of the file: " + outcome() + ".";
  }

  /// The last words, and the exit code.
  int finish() {
    std::fputs(view(robot_.status(), -1).c_str(), stdout);
    if (const std::string recorded = cameras_ ? cameras_->finish() : ""; !recorded.empty()) say(recorded);
    if (joints_ && joints_->dropped() > 0)
      say(std::to_string(joints_->dropped()) +
          " cycles are missing in the joints' file: this program came too late, or a "
          "joint was silent");
    for (const std::string& line : faults_.missed()) say(line);
    for (const std::filesystem::path& log : devices_.logs()) say("log: " + log.string());
    if (session_) report();
    const std::string fault = log_fault();
    if (follow_) say("follow: " + outcome());
    if (!fault.empty()) std::fprintf(stderr, "foresight: %s\n", fault.c_str());
    return fault.empty() && (!follow_ || follow_->succeeded()) ? 0 : 1;
  }

 private:
  std::string outcome() const { return follow_->outcome().empty() ? "interrupted" : follow_->outcome(); }
  /// "" where all logs are complete.
  std::string log_fault() {
    const std::string fault = joints_ ? joints_->fault() : "";
    return fault.empty() ? devices_.log_fault() : fault;
  }
  std::string view(const RobotStatus& status, int selected) const {
    std::string out = status_text(rig_, status, devices_.buses(), selected);
    if (cameras_) out += camera_text(cameras_->watch().line());
    if (const std::string fault = cameras_ ? cameras_->registration_trouble() : ""; !fault.empty())
      out += "  poses: " + fault + "\n";
    return out;
  }
  void report() {
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
    say("session: " + report_.string());
  }
  void show(RobotTime now, const RobotStatus& status) {
    if (!keyboard_.is_terminal() || now - shown_ < kRedraw) return;
    shown_ = now;
    std::string text = view(status, follow_ ? -1 : static_cast<int>(keys_.selected()));
    text += std::string("\n") + KeyOperator::help() + "\n";
    if (keys_.asks_for_consent()) text += "Every joint will look for home, slowly. Is the robot's way clear? y/n\n";
    std::fputs(("\x1b[H\x1b[J" + text).c_str(), stdout);
    std::fflush(stdout);
  }
  void notify(RobotTime now, const RobotStatus& status) {
    const auto period = service_watchdog_period();
    if (!period || now - notified_ < *period / 2) return;
    if (life_.goes_on(now, status)) notify_service("WATCHDOG=1");
    notified_ = now;
  }

  const Rig& rig_;
  const RobotDevices& devices_;
  Robot& robot_;
  RobotCameras* cameras_;
  std::optional<JointLog> joints_;
  std::optional<SessionRecord> session_;
  std::filesystem::path report_;
  MockFaults faults_;
  Keyboard keyboard_;
  KeyOperator keys_;
  std::optional<FollowOperator> follow_;
  std::vector<Commander*> commanders_;
  LoopLife life_;
  RobotTime shown_, notified_;
};

/// What shows the robot; at most one of them.
struct Windows {
  std::unique_ptr<LiveView> view;
  std::unique_ptr<RigBody> body;  // of `rig`
  std::unique_ptr<RigWindow> rig;
};

/// A window that fails ends, and the robot with it, under control.
void run_guarded(RigWindow& window, const std::function<bool()>& stopped) noexcept {
  try {
    window.run(stopped);
  } catch (const std::exception& error) {
    say(error.what());
  }
}

int run_stepped(SteppedClock& clock, Robot& robot, Console& console, RobotDevices& devices, RobotCameras* cameras,
                const Windows& windows) {
  LiveView* const view = windows.view.get();
  devices.bring_up(say);
  std::stop_source stop;
  if (cameras) clock.every(kTick, [cameras](RobotTime) { cameras->step(); });
  clock.every(kTick, [&](RobotTime now) {
    if (view && !view->step()) stop.request_stop();
    if (!stop.stop_requested() && (!console.tick(now) || stop_requested())) stop.request_stop();
  });
  robot.run(clock, stop.get_token());
  const int code = console.finish();
  if (view) view->finish(!stop_requested(), console.trouble());
  return stop_requested() ? kStopped : code;
}

int run_real(MonotonicClock& clock, Robot& robot, Console& console, RobotDevices& devices, RobotCameras* cameras,
             const Windows& windows) {
  LiveView* const view = windows.view.get();
  const auto set_up = [&] {
    try {
      devices.bring_up(say);
    } catch (const std::exception& error) {
      say(error.what());
    }
  };
  {
    std::promise<void> up;
    std::jthread loop([&](const std::stop_token& stop) {
      if (const std::string refused = make_real_time(kPriority); !refused.empty()) say(refused);
      // In this thread: the drives' watchdogs would find the bus silent while a new one gets its stack, every page of
      // which is locked in memory.
      try {
        devices.bring_up(say);
      } catch (...) {
        return up.set_exception(std::current_exception());
      }
      up.set_value();
      robot.run(clock, stop, set_up);
    });
    up.get_future().get();
    if (cameras) cameras->start();  // the drives already wait for the loop: that goes first
    notify_service("READY=1");
    std::atomic<bool> ended = false, unseen = false;
    const auto tick_on = [&] {
      for (RobotTime due = clock.now(); !stop_requested() && !unseen && console.tick(due);
           due = std::max(due + kTick, clock.now()))
        clock.sleep_until(due + kTick);
      ended = true;
    };
    if (view || windows.rig) {  // a window wants the main thread, and drawing must not make commands late
      std::jthread ticks(tick_on);
      const auto stopped = [&] { return ended.load(); };
      if (view)
        view->run(stopped);
      else
        run_guarded(*windows.rig, stopped);
      unseen = true;
    } else {
      tick_on();
    }
    notify_service("STOPPING=1");
  }
  const int code = console.finish();
  if (view) view->finish(!stop_requested(), console.trouble());
  return stop_requested() ? kStopped : code;
}

/// Null where there are none to run. In stepped time, pictures that nobody keeps are not drawn.
std::unique_ptr<RobotCameras> make_cameras(const Rig& rig, const RobotDevices& devices, const Robot& robot,
                                           Clock& clock, const Arguments& arguments) {
  if (!rig.cameras || !arguments.cameras || (arguments.stepped && arguments.record.empty() && !arguments.view))
    return nullptr;
  RobotCameraOptions options;
  options.mock = arguments.mock;
  if (!arguments.record.empty()) options.record = arguments.record;
  options.frames = arguments.view;
  if (!arguments.scene.empty()) options.scene = arguments.scene;
  if (options.mock || rig.cameras->mock()) say("lighting the lab");
  return std::make_unique<RobotCameras>(rig, devices, robot, clock, options);
}

/// Null without --view.
std::unique_ptr<LiveView> make_view(const Rig& rig, const Robot& robot, RobotCameras* cameras, const Clock& clock,
                                    const Arguments& arguments) {
  if (!arguments.view || !cameras) return nullptr;
  constexpr std::size_t kRoom = 64;
  const LiveViewOptions options{rig.name,
                                arguments.delay_ms.value_or(0),
                                arguments.outputs,
                                arguments.window || !arguments.outputs.any(),
                                arguments.stepped,
                                [&rig, &robot] {
                                  const RobotStatus status = robot.status();
                                  return hold_text(status.gate.hold, rig.joint_words(), status.time);
                                }};
  const auto trouble = [cameras] { return cameras->watch().line().fault; };
  return std::make_unique<LiveView>(cameras->scene(), cameras->frames().subscribe(kRoom), trouble, clock, options);
}

template <typename ClockKind>
int run_with(const Rig& rig, const Arguments& arguments,
             int (*run)(ClockKind&, Robot&, Console&, RobotDevices&, RobotCameras*, const Windows&)) {
  ClockKind clock;
  RobotDeviceOptions options;
  options.mock = arguments.mock;
  if (!arguments.record.empty()) options.log = can_log_beside(arguments.record);
  if (!arguments.log.empty()) options.log = arguments.log;
  RobotDevices devices(rig, clock, options);
  const auto shape = rig.shape();
  say(shape ? to_text(guarded_links(*rig.robot))
            : "the rig has no robot.urdf: nothing is checked against the surroundings");
  if (arguments.check_only) {
    devices.bring_up(say);
    return 0;
  }
  Robot robot(rig.gate_options(), shape.get(), devices.networks(), devices.drives());
  const auto cameras = make_cameras(rig, devices, robot, clock, arguments);
  Windows windows;
  windows.view = make_view(rig, robot, cameras.get(), clock, arguments);
  if (arguments.rig_view) {
    windows.body = std::make_unique<RigBody>(
        rig, arguments.scene.empty() ? std::nullopt : std::optional<std::filesystem::path>(arguments.scene));
    windows.rig = std::make_unique<RigWindow>(
        *windows.body,
        RigWindowOptions{"Foresight rig: " + rig.name, windows.body->rest(), 1320, 860, rig_feed(rig, robot)});
  }
  Console console(rig, devices, robot, cameras.get(), arguments);
  poll_stop_signals(SecondSignal::waits);  // a program that ends at once leaves the stop to the drives
  if (const std::string refused = arguments.stepped ? "" : lock_memory(); !refused.empty()) say(refused);
  return run(clock, robot, console, devices, cameras.get(), windows);
}

void check_rig_view(const Arguments& arguments) {
  if (!arguments.rig_view) return;
  for (const auto& [given, other] : {std::pair{arguments.view, "--view"}, {arguments.stepped, "--stepped"}})
    if (given)
      throw InputError("--rig-view", std::string("stands beside ") + other,
                       "leave one out; `foresight rig view RIG --out` draws without a window");
}

void check_view(const Rig& rig, const Arguments& arguments) {
  const bool asked[] = {arguments.delay_ms.has_value(), arguments.outputs.out.has_value(),
                        arguments.outputs.report.has_value(), arguments.outputs.html.has_value(), arguments.window};
  const char* const names[] = {"--delay-ms", "--out", "--report", "--html", "--window"};
  if (!arguments.scene.empty() && !arguments.view && !arguments.rig_view && arguments.record.empty())
    throw InputError("--scene", "belongs to --view, --rig-view or --record", "add one of them, or leave it out");
  if (!arguments.view) {
    for (std::size_t i = 0; i < std::size(asked); ++i)
      if (asked[i]) throw InputError(names[i], "belongs to --view", "add --view, or leave it out");
    return;
  }
  if (!rig.cameras || !arguments.cameras)
    throw InputError("--view", rig.cameras ? "stands beside --no-cameras" : "the rig has no cameras",
                     rig.cameras ? "leave one out" : "add them to the rig (docs/rig-files.md)");
}

/// What the OutputGuard cannot know: the rig says how many logs there are, and how they are called.
void check_logs(const Rig& rig, const Arguments& arguments) {
  namespace fs = std::filesystem;
  if (arguments.log.empty() || rig.buses.size() < 2) return;
  if (fs::exists(arguments.log) && !fs::is_regular_file(arguments.log))
    throw InputError("--log " + arguments.log, "is no file, and the rig's buses have a log each",
                     "give the name of a file: each bus's goes before its extension");
  if (arguments.session.empty()) return;
  for (const RigBus& bus : rig.buses) {
    const fs::path log = log_of(arguments.log, rig, bus);
    if (fs::weakly_canonical(log) == fs::weakly_canonical(arguments.session))
      throw InputError("--session-html " + arguments.session, "is the log of bus '" + bus.name + "', too",
                       "give another name");
  }
}

int run(const Arguments& arguments) {
  const Rig rig = read_rig(arguments.rig);
  check_logs(rig, arguments);
  check_rig_view(arguments);
  check_view(rig, arguments);
  parse_mock_faults(arguments.faults, rig, arguments.mock);
  if (!arguments.record.empty() && (!rig.cameras || !arguments.cameras))
    throw InputError("--record", rig.cameras ? "stands beside --no-cameras" : "the rig has no cameras",
                     rig.cameras ? "leave one out" : "add them to the rig (docs/rig-files.md)");
  if (!arguments.stepped) return run_with<MonotonicClock>(rig, arguments, run_real);
  for (const RigBus& bus : rig.buses)
    if (!arguments.mock && bus.interface != "mock")
      throw InputError("--stepped", "bus '" + bus.name + "' is a real one, whose time cannot be stepped",
                       "add --mock, or leave --stepped out");
  if ((arguments.view || !arguments.record.empty()) && !arguments.mock && !rig.cameras->mock())
    throw InputError("--stepped", "the cameras are real ones, whose time cannot be stepped",
                     "add --mock, or leave --stepped out");
  return run_with<SteppedClock>(rig, arguments, run_stepped);
}

}  // namespace

void add_robot_command(Command& app, std::function<int()>& action) {
  auto* command = app.add_subcommand("robot", "Runs the robot side of a rig: drives behind a safety gate");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("RIG", arguments->rig, "Rig file (docs/rig-files.md)")->reads()->required();
  command->add_flag("--mock", arguments->mock,
                    "Emulated drives on every bus, and the mock lab before the cameras, whatever the rig says");
  command
      ->add_option("--follow", arguments->follow,
                   "CSV file with the columns time_s and names of joints; enables, follows it and ends")
      ->reads();
  command->add_flag("--home", arguments->may_home,
                    "Consent: with --follow, joints that are not homed look for home, slowly");
  command->add_option("--log", arguments->log, "candump log of all frames: FILE, or FILE-BUS of each bus")
      ->writes(can_log_outputs);
  command
      ->add_option("--session-html", arguments->session,
                   "Report of the session: what the robot did and why, every joint over time, the buses' load; the\n"
                   "plots' series as JSON beside it")
      ->writes(page_outputs);
  command
      ->add_option("--record", arguments->record,
                   "Writes what the cameras see as a run into this folder, and beside it the CAN logs\n"
                   "(OUT-can-BUS.log) and the joints (OUT-joints.csv, as --follow reads them)")
      ->writes(robot_recording_outputs);
  command->add_flag("--view", arguments->view,
                    "Shows the live scene beside the camera's image; its textures are as old as --delay-ms says");
  command->add_option("--delay-ms", arguments->delay_ms, "With --view: delay of images in milliseconds (default 0)")
      ->check(from_to(0.0, 1e4));
  add_view_outputs(*command, arguments->outputs);
  command->add_flag("--window", arguments->window, "With --view: a window also where pictures or reports are written");
  command->add_flag("--rig-view", arguments->rig_view,
                    "Shows the robot in three dimensions as it moves, with what the gate guards (foresight rig view)");
  command
      ->add_option("--scene", arguments->scene,
                   "With --view, --rig-view or --record: the scene around the robot, in place of the rig's `scene:`")
      ->reads();
  command->add_flag("!--no-cameras", arguments->cameras, "Leaves the rig's cameras alone");
  command->add_flag("--stepped", arguments->stepped,
                    "As fast as the machine can, the same on every run; only with mock drives");
  command->add_option("--fault", arguments->faults,
                      "JOINT:KIND@TIME: what goes wrong with a mock drive, so many seconds after the start: stuck,\n"
                      "following_error, lost_node, noisy_encoder or lost_power; again for more");
  command->add_flag("--check", arguments->check_only, "Only identify and configure the drives; move nothing");
  command->footer(
      "On a terminal, keys enable, home, move and stop the robot; space is a stop. A software stop does not replace a\n"
      "hardware emergency stop. The drives stop on their own when this program ends in whatever way.\n\n"
      "Exit codes: 0 done, 1 stopped, held back or a device failed, 2 wrong input, 130 Ctrl-C or SIGTERM.\n\n"
      "Example: foresight robot configs/minerva.yaml --mock --home --follow motion.csv --log session.log");
  command->callback([arguments, &action] { action = [arguments] { return run(*arguments); }; });
}

}  // namespace foresight
