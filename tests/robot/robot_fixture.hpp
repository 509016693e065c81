// A robot of an arm's joint and a gripper, whose drives answer at once.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "drivers/robot/robot.hpp"
#include "tests/robot/prompt_drive.hpp"

namespace foresight::robot_test {

class RobotTest : public testing::Test {
 protected:
  RobotTest() {
    for (PromptDrive& drive : drives_) drive.state.homed = true;
  }
  static GateOptions options() {
    GateOptions out;
    out.joints = {{"arm", {-2, 2, 1, 4, 60}, 0.2}, {"grip", {0, 0.1, 0.1, 1, 20}, 0.02, true}};
    out.ramp_s = 0;
    return out;
  }
  void run(int cycles) {
    for (int i = 0; i < cycles; ++i) {
      now_ = now_ + std::chrono::milliseconds(4);
      robot_.cycle(now_);
    }
  }
  void command(double arm, double grip, bool deadman = true) {
    MotionCommand c{1, ++sequence_, now_, deadman, 2, {}};
    c.position[0] = arm;
    c.position[1] = grip;
    robot_.submit(c);
  }
  void make_ready() {
    robot_.ask(RobotRequest::enable);
    run(3);
    ASSERT_EQ(robot_.status().phase, RobotPhase::ready);
  }
  void get_moving() {
    make_ready();
    command(0, 0.05, false);
    run(1);
    for (int i = 0; i < 200; ++i) {
      command(1.9, 0.05);
      run(1);
    }
    ASSERT_GT(robot_.status().set_point[0].velocity, 0.5);
  }
  RobotTime now_{1'000'000'000};
  std::uint64_t sequence_ = 0;
  std::vector<PromptDrive> drives_{std::vector<PromptDrive>(2)};
  PromptNetwork network_{drives_};
  Robot robot_{options(), nullptr, {&network_}, {&drives_[0], &drives_[1]}};
};

}  // namespace foresight::robot_test
