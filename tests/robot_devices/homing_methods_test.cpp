// Homing of a whole arm by every method that its drives claim, from any pose; and by one that they do not have.
#include <gmock/gmock.h>

#include <random>

#include "common/error.hpp"
#include "sim/drives/homing_search.hpp"
#include "tests/robot_devices/live_robot.hpp"
#include "tests/support/folders.hpp"

namespace foresight::homing_methods_test {
namespace {

using namespace std::chrono_literals;

/// Homes; how far each joint's drive is from the truth at the end, and whether all found home.
void expect_homes(LiveRobot& live, const std::string& what) {
  live.robot().ask(RobotRequest::enable);
  live.run(1s);
  ASSERT_EQ(live.robot().status().phase, RobotPhase::ready) << what << live.robot().status().refused;
  live.robot().ask(RobotRequest::home);
  live.run(100ms);
  for (int i = 0; i < 5000 && live.robot().status().phase == RobotPhase::homing; ++i) live.run(200ms);
  const RobotStatus status = live.robot().status();
  ASSERT_EQ(status.phase, RobotPhase::ready)
      << what << ": " << to_string(status.gate.reason) << ", joint " << status.waiting_for;
  EXPECT_TRUE(status.all_homed) << what;
  for (std::size_t i = 0; i < live.rig().joints.size(); ++i) {
    const DriveConfig& d = live.rig().joints[i].drive;
    const double truth = live.devices().shaft_at(d.name, status.feedback[i].time).value();
    EXPECT_NEAR(status.feedback[i].position, truth, 1e-3 * (d.max_position - d.min_position)) << what << ": " << d.name;
  }
}

TEST(HomingMethods, EachIsThatOfAJointSomewhere) {
  const Rig original = read_rig(source_folder() / "configs/cia402.yaml");
  const auto& methods = sim::served_homing_methods();
  std::mt19937 random(3);
  for (std::size_t first = 0; first < methods.size(); first += original.joints.size()) {
    Rig rig = original;
    std::map<std::string, double> start;
    for (std::size_t i = 0; i < rig.joints.size(); ++i) {
      RigJoint& joint = rig.joints[i];
      DriveConfig& d = joint.drive;
      joint.absolute = false;
      joint.homing_method = methods[(first + i) % methods.size()];
      d.homing_velocity = 0.25 * d.max_velocity;
      const auto method = sim::homing_method(joint.homing_method);
      const double range = d.max_position - d.min_position;
      d.direction = i % 2 == 0 ? 1 : -1;
      // Home where its switch lies: at an end of the range, or inside. A drive calls home 0.
      const bool limit = method && method->input != 0 && method->input != sim::kHomeSwitch;
      const bool at_low_end = limit && (method->way > 0) == (d.direction > 0);
      d.offset = limit ? (at_low_end ? d.min_position + 0.01 * range : d.max_position - 0.01 * range)
                       : d.min_position + 0.4 * range;
      if (method && (method->input != 0))
        start[d.name] = d.min_position + std::uniform_real_distribution(0.02, 0.98)(random) * range;
      if (!method) start[d.name] = d.offset;  // here is home
    }
    LiveRobot live(rig, start);
    expect_homes(live, "methods from " + std::to_string(methods[first]));
  }
}

// Like an elbow that never stretches.
TEST(HomingMethods, AJointWhoseRangeExcludesZeroHomesWithinIt) {
  for (const char* file : {"minerva.yaml", "cia402.yaml"})
    for (const double side : {1.0, -1.0}) {
      Rig rig = read_rig(source_folder() / "configs" / file);
      DriveConfig& d = rig.joints[3].drive;
      d.min_position = side > 0 ? 0.3 : -1.9;
      d.max_position = side > 0 ? 1.9 : -0.3;
      d.direction = side > 0 ? 1 : -1;
      LiveRobot live(rig);
      expect_homes(live, file);
      EXPECT_NEAR(live.robot().status().feedback[3].position, side * 1.1, 0.1) << "in the middle";
      EXPECT_NEAR(live.robot().status().feedback[1].position, 0, 0.1) << "others where they had it";
    }
}

TEST(HomingMethods, OneThatADriveLacksIsSaidBeforeAnythingMoves) {
  Rig rig = read_rig(source_folder() / "configs/cia402.yaml");
  rig.joints[2].homing_method = 15;
  rig.joints[2].absolute = false;
  SteppedClock clock;
  RobotDevices devices(rig, clock, {.mock = true, .log = {}, .mock_without_limits = false});
  try {
    devices.bring_up([](const std::string&) {});
    FAIL() << "nothing was thrown";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("upper_arm_roll (node 3 on "));
    EXPECT_THAT(error.what(), testing::HasSubstr("does not have homing method 15; it has 1, 2, 3"));
  }
}

}  // namespace
}  // namespace foresight::homing_methods_test
