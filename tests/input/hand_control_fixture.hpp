// A hand that is moved by hand at the lab's rig, and what none of its motions may do.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "tests/input/hand_world.hpp"

namespace foresight {

class HandControlTest : public testing::Test {
 protected:
  HandControlTest() { world_.hand().settings().frame = HandFrame::base; }
  void TearDown() override {
    EXPECT_EQ(world_.steps_too_long, 0);
    EXPECT_EQ(world_.moved_while_open, 0);
    EXPECT_EQ(world_.jumps_at_press, 0);
    EXPECT_EQ(world_.shafts_moved_at_rest, 0);
  }
  /// The hand goes there, evenly, from where it is.
  const HandCycle& go(const Eigen::Vector3d& to, int cycles, bool held = true, bool clutched = true) {
    const Eigen::Vector3d from = at_;
    for (int i = 1; i <= cycles; ++i) {
      at_ = from + (to - from) * i / cycles;
      world_.cycle(device_at(at_, held, clutched));
    }
    return world_.hand().last();
  }
  const HandCycle& stay(int cycles, bool held = true, bool clutched = true) { return go(at_, cycles, held, clutched); }
  /// The switch is pressed, and the ramp is over.
  void engage() {
    stay(60, false);
    ASSERT_EQ(stay(400).phase, HandPhase::driving) << describe(world_.hand().last(), world_.joints()).name;
    ASSERT_EQ(world_.gate().state, GateState::following);
  }
  Eigen::Vector3d tool() { return world_.hand().last().T_base_tip.translation(); }
  std::string words() { return describe(world_.hand().last(), world_.joints()).name; }

  HandWorld world_;
  Eigen::Vector3d at_{0, 0, 0};
};

}  // namespace foresight
