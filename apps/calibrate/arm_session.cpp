#include "apps/calibrate/arm_session.hpp"

#include <fmt/core.h>

#include <cstdio>
#include <opencv2/imgproc.hpp>

#include "apps/calibrate/arm_stations.hpp"
#include "calibration/target/board_drawing.hpp"
#include "calibration/target/capture_picture.hpp"
#include "calibration/target/find_corners.hpp"
#include "common/atomic_file.hpp"
#include "common/error.hpp"
#include "common/partial_path.hpp"
#include "common/stop_signal.hpp"
#include "common/text.hpp"
#include "operators/station_operator.hpp"
#include "rig/open_stereo.hpp"
#include "rig/rig_scene.hpp"
#include "session/robot_loop.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kTick = 10ms;
constexpr Duration kPairsSilent = 5s;  // without a pair
constexpr int kMostMissesInARow = 25;  // stations at which nothing was seen
constexpr std::size_t kFewestViews = 8;
constexpr double kBoardBeyondFlange = 0.19;  // m, along the flange's z: beyond the mock lab's fingers

void say(const std::string& line) {
  std::fprintf(stderr, "arm: %s\n", line.c_str());
}

/// The board on the mock robot's flange, its front away from it. A flange without a body hangs on a link that has one.
sim::MovingPrint board_on_arm(const Board& board, const JointChain& chain) {
  const BoardPicture picture = board_picture(board);
  Pose T_part_print = Pose::Identity();
  auto link = static_cast<std::size_t>(chain.flange);
  while (link > 0 && chain.robot.links[link].mesh.triangles.empty() &&
         chain.robot.joints[link - 1].kind == UrdfJoint::Kind::fixed) {
    T_part_print = chain.robot.joints[link - 1].T_parent_joint * T_part_print;
    link = static_cast<std::size_t>(chain.robot.links[link].parent);
  }
  T_part_print.translate(Eigen::Vector3d(0, 0, kBoardBeyondFlange));
  T_part_print.rotate(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
  return {{to_string(board), picture.picture, picture.width_m, picture.height_m},
          [T_part_print](double) { return T_part_print; },
          chain.robot.links[link].name};
}

struct View {
  std::string name;
  std::vector<double> joints;
};

/// What goes on beside the control loop, tick by tick.
class Session {
 public:
  Session(const ArmSessionOptions& options, const Rig& rig, Robot& robot, StereoCamera& cameras, bool polled)
      : options_(options),
        rig_(rig),
        robot_(robot),
        cameras_(cameras),
        polled_(polled),
        finder_(parse_board(options.board)),
        chain_(joint_chain_of(*rig.robot, options.base, options.flange, options.rig)),
        operator_(rig.joint_words(), options.may_home) {}

  /// False: the session is over.
  bool tick(RobotTime now) {
    if (polled_ && operator_.waiting()) cameras_.poll();  // what is on the way between stations is not looked at
    if (operator_.waiting()) at_station(now);
    Commander* const one[] = {&operator_};
    return serve(one, robot_, now) && failure_.empty();
  }

  /// Throws what ended the session before it was done.
  void finish() const {
    if (!operator_.failure().empty()) throw RuntimeFailure(operator_.failure(), "see why, and start again");
    if (!failure_.empty()) throw RuntimeFailure(failure_, cure_);
    if (views_.size() < kFewestViews)
      throw RuntimeFailure(
          "the board was seen at " + std::to_string(views_.size()) + " stations only",
          "start where the camera sees it whole and from the front, with room around" + words_of_unseen());
    std::string table = "image";
    for (const int joint : chain_.joints) table += "," + chain_.robot.joints[static_cast<std::size_t>(joint)].name;
    for (const View& view : views_) {
      table += "\n" + view.name;
      for (const double q : view.joints) table += fmt::format(",{:.7f}", q);
    }
    write_file_atomically(options_.views / "joints.csv", table + "\n");
    std::error_code none;
    std::filesystem::remove(unseen_file(), none);  // that a session before left
  }

 private:
  void fail(std::string what, std::string cure) { failure_ = std::move(what), cure_ = std::move(cure); }

  std::string unseen_file() const { return without_end_slash(options_.views).string() + "-unseen.png"; }

  /// Keeps what the camera saw instead of the board: nobody may be where a screen shows it.
  std::string words_of_unseen() const {
    if (unseen_.empty()) return "";
    const std::string file = unseen_file();
    write_picture(file, unseen_);
    return "; " + file + " is the last picture without the board";
  }

  void at_station(RobotTime now) {
    if (!stations_) return begin();
    if (!operator_.missed().empty()) {
      say("held back: " + operator_.missed());
      return leave(false, false);
    }
    const auto pair = cameras_.take(Duration{0});
    if (!pair || pair->left.time < operator_.still_since()) {
      if (now - operator_.still_since() > kPairsSilent)
        fail("no picture came in 5 s: " + fault_text(cameras_.status()), "check the cameras of the rig");
      return;
    }
    const cv::Mat& picture = options_.side == "right" ? pair->right.bgr : pair->left.bgr;
    const bool seen = look(picture);
    if (!seen) picture.copyTo(unseen_);
    if (first_ && !seen && !options_.start.empty()) say("the board is not in view at --start");
    if (first_ && !seen && options_.start.empty())
      say("the board is not in view from where the robot stands: --start gives another place");
    first_ = false;
    leave(true, seen);
  }

  void begin() {
    const RobotStatus status = robot_.status();
    JointValues start{};
    for (std::size_t i = 0; i < rig_.joints.size(); ++i) start[i] = status.feedback[i].position;
    stations_.emplace(rig_, chain_, start, options_.seed);
    if (!options_.start.empty()) {
      if (options_.start.size() != stations_->joints().size())
        return fail("--start has " + std::to_string(options_.start.size()) + " positions, the arm " +
                        std::to_string(stations_->joints().size()) + " joints",
                    "give one position for each joint between base and flange");
      for (std::size_t i = 0; i < options_.start.size(); ++i) start[stations_->joints()[i]] = options_.start[i];
      stations_->start_at(start);
    }
    go_on();
  }

  bool look(const cv::Mat& picture) {
    cv::Mat grey;
    cv::cvtColor(picture, grey, cv::COLOR_BGR2GRAY);
    if (!finder_.find(grey)) return false;
    const RobotStatus status = robot_.status();
    JointValues positions{};
    for (std::size_t i = 0; i < rig_.joints.size(); ++i) positions[i] = status.feedback[i].position;
    const std::string name = fmt::format("view{:02d}", views_.size() + 1);
    write_picture(options_.views / (name + ".png"), picture);
    views_.push_back({name, stations_->of_chain(positions)});
    say(fmt::format("{} of {}: the board is in view", views_.size(), options_.most_views));
    return true;
  }

  void leave(bool reached, bool seen) {
    misses_ = seen ? 0 : misses_ + 1;
    stations_->judge(reached, seen);
    if (std::ssize(views_) >= options_.most_views) return operator_.finish();
    if (misses_ >= kMostMissesInARow)
      return fail(std::to_string(misses_) + " stations in a row did not show the board",
                  "start where the camera sees it whole and from the front: --start, or guide the arm there first" +
                      words_of_unseen());
    go_on();
  }

  void go_on() {
    const auto station = stations_->next();
    if (!station) return operator_.finish();
    operator_.go_to(*station);
  }

  const ArmSessionOptions& options_;
  const Rig& rig_;
  Robot& robot_;
  StereoCamera& cameras_;
  bool polled_;
  BoardFinder finder_;
  JointChain chain_;
  StationOperator operator_;
  std::optional<ArmStations> stations_;
  std::vector<View> views_;
  bool first_ = true;
  cv::Mat unseen_;  // the last picture without the board
  int misses_ = 0;
  std::string failure_, cure_;
};

void run_stepped(SteppedClock& clock, Robot& robot, RobotDevices& devices, Session& session) {
  devices.bring_up(say);
  std::stop_source stop;
  clock.every(kTick, [&](RobotTime now) {
    if (!stop.stop_requested() && (!session.tick(now) || stop_requested())) stop.request_stop();
  });
  robot.run(clock, stop.get_token());
}

void run_real(MonotonicClock& clock, Robot& robot, RobotDevices& devices, Session& session) {
  const RobotLoop loop(clock, robot, devices, say);
  for (RobotTime due = clock.now(); !stop_requested() && session.tick(clock.now());
       due = std::max(due + kTick, clock.now()))
    clock.sleep_until(due + kTick);
}

template <typename ClockKind>
void run_with(const ArmSessionOptions& options, const Rig& rig,
              void (*run)(ClockKind&, Robot&, RobotDevices&, Session&)) {
  constexpr bool kStepped = std::is_same_v<ClockKind, SteppedClock>;
  ClockKind clock;
  RobotDeviceOptions device_options;
  device_options.mock = options.mock;
  RobotDevices devices(rig, clock, device_options);
  const auto shape = rig.shape();
  Robot robot(rig.gate_options(), shape.get(), devices.networks(), devices.drives());
  const StereoConfig config = options.mock ? as_mock(*rig.cameras) : *rig.cameras;
  MockWorld world;
  if (config.mock()) {
    say("lighting the lab");
    world = mock_world(rig);
    world.board =
        board_on_arm(parse_board(options.board), joint_chain_of(*rig.robot, options.base, options.flange, options.rig));
  }
  OpenStereo opened = open_stereo(
      config, [&](std::string_view joint, RobotTime time) { return devices.shaft_at(shaft_name(rig, joint), time); },
      clock, world);
  Session session(options, rig, robot, *opened.cameras, kStepped);
  if (kStepped)
    opened.cameras->start_polled();
  else
    opened.cameras->start();
  poll_stop_signals(SecondSignal::waits);  // a program that ends at once leaves the stop to the drives
  run(clock, robot, devices, session);
  opened.cameras->stop();
  if (!stop_requested()) session.finish();
}

void require_usable(const ArmSessionOptions& options, const Rig& rig) {
  if (!rig.robot) throw InputError(options.rig.string(), "has no robot.urdf", "add it to the rig (docs/rig-files.md)");
  if (!rig.cameras) throw InputError(options.rig.string(), "has no cameras", "add them to the rig (docs/rig-files.md)");
  if (options.board.empty())
    throw InputError("--board", "is missing", "name the board on the arm, such as chessboard:6x5:0.02");
  if (options.stepped) require_mock(rig, options.mock, true);
}

}  // namespace

void add_arm_session(Command& command, ArmSessionOptions& options) {
  command.add_flag("--guided", options.guided,
                   "Moves the robot of --rig from station to station, takes the views, then solves");
  command
      .add_option("--views", options.views, "With --guided: folder for the views (default: OUT without ending, -views)")
      ->writes(
          [](const std::filesystem::path& folder) { return std::vector{new_output(folder, Output::Kind::folder)}; });
  command
      .add_option("--start", options.start,
                  "With --guided: joints, rad, at which the board is in view (default: where the arm stands)")
      ->expected(1, 16);
  command.add_option("--stations", options.most_views, "With --guided: views that are taken")
      ->check(from_to(8, 100))
      ->capture_default_str();
  command.add_flag("--mock", options.mock,
                   "With --guided: emulated drives, and the mock lab with the board on its arm");
  command.add_flag("--stepped", options.stepped, "With --guided: as fast as the machine can; only with mock drives");
  command.add_flag("--home", options.may_home, "With --guided: joints that are not homed look for home, slowly");
}

bool run_arm_session(const ArmSessionOptions& options) {
  const Rig rig = read_rig(options.rig);
  require_usable(options, rig);
  std::error_code ignored;
  if (std::filesystem::exists(options.views) && !std::filesystem::is_empty(options.views, ignored))
    throw InputError(options.views.string(), "exists and is not empty", "name another folder with --views");
  std::filesystem::create_directories(options.views);

  try {
    if (options.stepped)
      run_with<SteppedClock>(options, rig, run_stepped);
    else
      run_with<MonotonicClock>(options, rig, run_real);
  } catch (...) {
    std::filesystem::remove_all(options.views, ignored);
    throw;
  }
  if (!stop_requested()) return true;
  std::filesystem::remove_all(options.views, ignored);
  say("stopped by the operator; the drives hold, and nothing is kept");
  return false;
}

}  // namespace foresight
