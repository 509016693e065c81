// A gate of two joints, and drives that do exactly what they are told.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>

#include "drivers/robot/safety_gate.hpp"

namespace foresight {

inline constexpr double kDt = 0.004;

inline GateOptions two_joints() {
  GateOptions out;
  out.joints = {{"shoulder", {-2, 2, 1, 4, 60}, 0.2}, {"elbow", {-1, 1, 2, 8, 120}, 0.2}};
  out.ramp_s = 0.2;
  return out;
}

/// The gate with drives that do exactly what they are told, one cycle late.
class SafetyGateTest : public testing::Test {
 protected:
  explicit SafetyGateTest(GateOptions options = two_joints()) : gate_(std::move(options), nullptr) {
    for (DriveFeedback& f : feedback_) f = {now_, 0, 0, DriveState::enabled};
    EXPECT_TRUE(gate_.reset(feedback_, now_));
  }
  MotionCommand command(double shoulder, double elbow, bool deadman = true) {
    MotionCommand out{7, ++sequence_, now_, deadman, 2, {}};
    out.position[0] = shoulder;
    out.position[1] = elbow;
    return out;
  }
  void cycle(const std::optional<MotionCommand>& what, bool drives_follow = true) {
    now_ = now_ + seconds(kDt);
    const std::array before{gate_.set_point(0), gate_.set_point(1)};
    for (std::size_t i = 0; i < 2 && drives_follow; ++i) {
      feedback_[i].time = now_;
      feedback_[i].position = before[i].position;
    }
    gate_.step(now_, {what ? &*what : nullptr, what ? 1u : 0u}, feedback_);
    for (std::size_t i = 0; i < 2; ++i) {
      const JointMotion& m = gate_.set_point(i);
      const JointLimits& l = gate_.options().joints[i].limits;
      ASSERT_TRUE(m.position >= l.min_position - 1e-9 && m.position <= l.max_position + 1e-9) << m.position;
      ASSERT_LE(std::abs(m.velocity), l.velocity * (1 + 1e-9));
      ASSERT_LE(std::abs(m.acceleration), l.acceleration * (1 + 1e-9));
      ASSERT_LE(std::abs(m.acceleration - before[i].acceleration), l.jerk * kDt * (1 + 1e-6));
      ASSERT_LE(std::abs(m.position - before[i].position), l.velocity * kDt * (1 + 1e-6));
    }
  }
  void engage() {
    cycle(command(0, 0, false));
    cycle(command(0, 0));
    ASSERT_EQ(gate_.status().state, GateState::following);
  }
  /// Until the shoulder moves fast.
  void get_moving() {
    engage();
    for (int i = 0; i < 100; ++i) cycle(command(1.8, 0.5));
    ASSERT_GT(gate_.set_point(0).velocity, 0.3);
  }
  void expect_stopped_at_rest(GateReason reason) {
    EXPECT_EQ(gate_.status().state, GateState::stopped);
    EXPECT_EQ(gate_.status().reason, reason) << to_string(gate_.status().reason);
    for (int i = 0; i < 300; ++i) cycle(command(-1, -1));
    EXPECT_TRUE(gate_.set_points_rest());
    EXPECT_EQ(gate_.status().reason, reason) << "it stays visible";
    EXPECT_EQ(gate_.status().state, GateState::stopped);
  }

  RobotTime now_{1'000'000'000};
  std::uint64_t sequence_ = 0;
  std::array<DriveFeedback, 2> feedback_;
  SafetyGate gate_;
};

}  // namespace foresight
