// Sessions in which everything goes wrong that a device, its operator, the line and the robot can do.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

#include "input/recorded_tracker.hpp"
#include "tests/input/hand_world.hpp"
#include "tests/support/folders.hpp"

namespace foresight::hand_sessions_test {
namespace {

using namespace std::chrono_literals;

/// An operator and a device, drawn from a seed.
class Session {
 public:
  explicit Session(std::uint64_t seed) : random_(seed), world_(uniform(0, 1) < 0.5 ? 20ms : 250ms) {
    world_.hand().settings().frame = uniform(0, 1) < 0.5 ? HandFrame::base : HandFrame::view;
    for (int i = 0; i < 3; ++i) {
      way_[i] = uniform(0, 0.25);
      pace_[i] = uniform(0.5, 5);
    }
  }
  void run(int cycles) {
    for (int i = 0; i < cycles; ++i) cycle();
    world_.cycles(60, device_at({0, 0, 0}, false));
  }
  HandWorld& world() { return world_; }
  int faults() const { return faults_; }

 private:
  double uniform(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }
  bool chance(double per_second) { return uniform(0, 1) < per_second * world_.cycle_seconds(); }

  void cycle() {
    operate();
    TrackerState device = hand();
    device.buttons.set(TrackerButton::deadman, held_);
    device.buttons.set(TrackerButton::clutch, clutched_);
    device.grip = grip_;
    device.time = world_.now();
    // A fault lasts a while.
    if (fault_ < 0 && chance(0.5)) {
      fault_ = std::uniform_int_distribution(0, 11)(random_);
      left_ = std::uniform_int_distribution(1, 40)(random_);
      frozen_ = device;
      ++faults_;
    }
    if (fault_ >= 0) spoil(device);
    if (fault_ >= 0 && --left_ <= 0) heal();
    world_.cycle(device, true);
  }
  // Lets go of the switch and presses it as people do, whatever the program says.
  void operate() {
    if (chance(held_ ? 0.4 : 3)) held_ = !held_;
    if (chance(clutched_ ? 0.5 : 3)) clutched_ = !clutched_;
    if (chance(0.2)) world_.hand().set_mode(uniform(0, 1) < 0.7 ? HandMode::tool : HandMode::joints);
    if (chance(0.3)) world_.hand().settings().translation_scale = uniform(0, 3);
    if (chance(0.3)) world_.hand().settings().rotation_scale = uniform(0, 2);
    if (chance(0.3)) world_.hand().settings().lock_rotation = {chance(60), chance(60), chance(60)};
    if (chance(1)) grip_ = uniform(0, 1);
    if (chance(1)) world_.others[8] = uniform(-3, 3);
    if (chance(0.5)) world_.T_base_view.linear() = Eigen::Quaterniond::UnitRandom().toRotationMatrix();
  }
  TrackerState hand() {
    seconds_ += world_.cycle_seconds();
    TrackerState out;
    out.connected = out.tracked = true;
    for (int i = 0; i < 3; ++i) out.T_space_hand.translation()[i] = way_[i] * std::sin(pace_[i] * seconds_) + drift_[i];
    out.T_space_hand.translation() += 3e-4 * Eigen::Vector3d(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
    const double angle = 0.8 * std::sin(1.3 * seconds_);
    out.T_space_hand.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d(0.6, 0, 0.8)).toRotationMatrix();
    out.joint = 3;
    out.tilt_rate = std::cos(seconds_);
    out.joint_rate = std::sin(seconds_);
    return out;
  }
  void spoil(TrackerState& device) {
    switch (fault_) {
      case 0: device = TrackerState{}; break;  // unplugged
      case 1: device.tracked = false; break;
      case 2: device.T_space_hand = Pose::Identity(); break;  // lost, and says so by a pose
      case 3: device.T_space_hand.translation().y() = NAN; break;
      case 4: device.T_space_hand.linear() *= 1.5; break;
      case 5: device = frozen_; break;
      case 6: device.time = {device.time.ns + 1'700'000'000'000'000'000}; break;
      case 7: device.time = device.time - seconds(uniform(0, 2)); break;  // out of order
      case 8: device.T_space_hand.translation() += Eigen::Vector3d(uniform(-5, 5), uniform(-5, 5), 0); break;
      case 9: (uniform(0, 1) < 0.5 ? world_.up_cut : world_.down_cut) = true; break;
      case 10:
        if (left_ == 1) world_.stand_still(seconds(uniform(0, 0.6)));
        break;
      default: world_.robot().ask(left_ > 1 ? RobotRequest::emergency_stop : RobotRequest::reset); break;
    }
  }
  void heal() {
    if (fault_ == 11) world_.robot().ask(RobotRequest::reset);
    if (fault_ == 8) drift_[0] += uniform(-1, 1);  // it is somewhere else since
    world_.up_cut = world_.down_cut = false;
    fault_ = -1;
  }

  std::mt19937_64 random_;
  HandWorld world_;
  std::array<double, 3> way_{}, pace_{}, drift_{};
  double seconds_ = 0, grip_ = 0;
  bool held_ = false, clutched_ = false;
  int fault_ = -1, left_ = 0, faults_ = 0;
  TrackerState frozen_;
};

TEST(HandSessionsTest, NoJointStepsTooFarAndNothingMovesWhileTheSwitchIsOpen) {
  const bool takes_long = std::getenv("FORESIGHT_LONG") != nullptr;
  const int sessions = takes_long ? 2000 : 200;
  int driving = 0, presses = 0, following = 0, faults = 0;
  for (int seed = 0; seed < sessions; ++seed) {
    std::srand(static_cast<unsigned>(seed));  // Eigen draws views from there
    Session session(static_cast<std::uint64_t>(seed));
    session.run(500);
    const HandWorld& world = session.world();
    ASSERT_EQ(world.steps_too_long, 0) << "seed " << seed;
    ASSERT_EQ(world.moved_while_open, 0) << "seed " << seed;
    ASSERT_EQ(world.jumps_at_press, 0) << "seed " << seed;
    ASSERT_EQ(world.shafts_moved_at_rest, 0) << "seed " << seed;
    driving += world.driving;
    presses += world.presses;
    following += world.following;
    faults += session.faults();
  }
  RecordProperty("cycles_driving", driving);
  RecordProperty("presses", presses);
  EXPECT_GT(driving, 50 * sessions) << "cycles in which something was tried";
  EXPECT_GT(presses, sessions);
  EXPECT_GT(following, 100 * sessions);
  EXPECT_GT(faults, sessions);
}

TEST(HandSessionsTest, ASessionOfBothSidesRepeatsBitForBit) {
  const auto digest = [](std::uint64_t seed) {
    std::srand(static_cast<unsigned>(seed));
    Session session(seed);
    session.run(500);
    return session.world().digest;
  };
  EXPECT_EQ(digest(3), digest(3));
  EXPECT_NE(digest(3), digest(4));
}

// Other people's hands, whole.
class RecordedSessionTest : public testing::TestWithParam<const char*> {};

TEST_P(RecordedSessionTest, MovesTheRobotWithinItsLimits) {
  const auto file = data_folder() / GetParam();
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recorded data: " << file;
  const bool bare = std::string(GetParam()).starts_with("quest");  // hands that do not hold a switch all the time
  RecordedTracker device(read_tracker_trace(file, {.hold_switch = bare}));
  HandWorld world;
  world.hand().settings().frame = HandFrame::base;
  const OperatorTime end = world.now() + std::min(device.length(), Duration(15s));
  double farthest = 0;
  const Eigen::Vector3d begin = world.hand().last().T_base_tip.translation();
  while (world.now() < end) {
    world.cycle(device.read(world.now()), true);
    if (world.hand().last().phase == HandPhase::driving)
      farthest = std::max(farthest, (world.hand().last().T_base_tip.translation() - begin).norm());
  }
  EXPECT_EQ(world.steps_too_long + world.moved_while_open + world.jumps_at_press + world.shafts_moved_at_rest, 0);
  EXPECT_GT(world.driving, 30);
  EXPECT_GT(farthest, 0.002) << "the hand took the tool along";
}

INSTANTIATE_TEST_SUITE_P(Data, RecordedSessionTest,
                         testing::Values("desk_teleop/S7_T1_right.csv", "desk_teleop/S4_T1_right.csv",
                                         "quest_controllers/controllers.csv", "quest_controllers/hands.csv"),
                         [](const auto& of) {
                           std::string name = of.param;
                           for (char& c : name)
                             if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
                           return name;
                         });

}  // namespace
}  // namespace foresight::hand_sessions_test
