#include "drivers/robot/safety_gate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/error.hpp"

namespace foresight {
namespace {

constexpr double kDt = 0.004;

GateOptions two_joints() {
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
    gate_.step(now_, what, feedback_);
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
    EXPECT_TRUE(gate_.at_rest());
    EXPECT_EQ(gate_.status().reason, reason) << "it stays visible";
    EXPECT_EQ(gate_.status().state, GateState::stopped);
  }

  RobotTime now_{1'000'000'000};
  std::uint64_t sequence_ = 0;
  std::array<DriveFeedback, 2> feedback_;
  SafetyGate gate_;
};

TEST_F(SafetyGateTest, FollowsAnOperatorWhoEngages) {
  engage();
  for (int i = 0; i < 1500; ++i) cycle(command(1.5, -0.7));
  EXPECT_NEAR(gate_.set_point(0).position, 1.5, 1e-4);
  EXPECT_NEAR(gate_.set_point(1).position, -0.7, 1e-4);
  EXPECT_EQ(gate_.status().operator_id, 7u);
}

TEST_F(SafetyGateTest, DoesNotMoveBeforeTheDeadmanWasSeenOpen) {
  for (int i = 0; i < 500; ++i) cycle(command(1, 1));
  EXPECT_EQ(gate_.set_point(0).position, 0);
  EXPECT_EQ(gate_.status().state, GateState::idle);
}

TEST_F(SafetyGateTest, StartsSlowly) {
  engage();
  double fastest = 0;
  for (int i = 0; i < 12; ++i) {
    cycle(command(1.8, 0));
    fastest = std::max(fastest, gate_.set_point(0).velocity);
  }
  EXPECT_LT(fastest, 0.35) << "within the ramp";
}

TEST_F(SafetyGateTest, DropsCommandsThatMustNotBeFollowed) {
  engage();
  const auto expect_dropped = [&](MotionCommand bad, GateReason reason) {
    const auto before = gate_.status().dropped;
    const double target = gate_.set_point(0).position;
    cycle(bad);
    cycle(command(0, 0));
    EXPECT_EQ(gate_.status().dropped, before + 1) << to_string(reason);
    EXPECT_EQ(gate_.status().last_dropped, reason) << to_string(gate_.status().last_dropped);
    EXPECT_EQ(gate_.set_point(0).position, target);
  };
  expect_dropped(command(std::nan(""), 0), GateReason::not_finite);
  expect_dropped(command(0, INFINITY), GateReason::not_finite);
  expect_dropped(command(10, 0), GateReason::out_of_range);
  MotionCommand late = command(1, 0);
  late.time = now_ - seconds(1);
  expect_dropped(late, GateReason::expired);
  late.time = {std::numeric_limits<std::int64_t>::min()};
  late.sequence = ++sequence_;
  expect_dropped(late, GateReason::expired);
  MotionCommand early = command(1, 0);
  early.time = {std::numeric_limits<std::int64_t>::max()};
  expect_dropped(early, GateReason::from_the_future);
  MotionCommand again = command(1, 0);
  again.sequence = 1;
  expect_dropped(again, GateReason::out_of_order);
  MotionCommand other = command(1, 0);
  other.operator_id = 8;
  expect_dropped(other, GateReason::second_operator);
  MotionCommand few = command(1, 0);
  few.joints = 1;
  expect_dropped(few, GateReason::wrong_joint_count);
  few.joints = 1000;
  few.sequence = ++sequence_;
  expect_dropped(few, GateReason::wrong_joint_count);
}

TEST_F(SafetyGateTest, ALostOperatorStopsAndMustEngageAgain) {
  get_moving();
  for (int i = 0; i < 250; ++i) cycle(std::nullopt);  // one second
  EXPECT_EQ(gate_.status().state, GateState::idle);
  EXPECT_EQ(gate_.status().reason, GateReason::operator_lost);
  const double stood = gate_.set_point(0).position;
  for (int i = 0; i < 100; ++i) cycle(command(-1, 0));
  EXPECT_EQ(gate_.set_point(0).position, stood) << "back with the switch held: not yet";
  engage();
  for (int i = 0; i < 300; ++i) cycle(command(-1, 0));
  EXPECT_LT(gate_.set_point(0).position, stood);
}

TEST_F(SafetyGateTest, ABurstOfOldCommandsAfterAReconnectMovesNothing) {
  get_moving();
  std::vector<MotionCommand> held;
  for (int i = 0; i < 250; ++i) {
    held.push_back(command(-1.8, -1));
    cycle(std::nullopt);
  }
  ASSERT_TRUE(gate_.at_rest());
  const double stood = gate_.set_point(0).position;
  for (const MotionCommand& old : held) cycle(old);
  EXPECT_EQ(gate_.set_point(0).position, stood);
}

TEST_F(SafetyGateTest, ReleasingTheDeadmanStops) {
  get_moving();
  cycle(command(1.8, 0, false));
  EXPECT_EQ(gate_.status().state, GateState::stopping);
  for (int i = 0; i < 200; ++i) cycle(command(1.8, 0, false));
  EXPECT_EQ(gate_.status().state, GateState::idle);
  EXPECT_TRUE(gate_.at_rest());
}

TEST_F(SafetyGateTest, AnEmergencyStopLatchesUntilReset) {
  get_moving();
  gate_.emergency_stop("the button");
  expect_stopped_at_rest(GateReason::emergency_stop);
  EXPECT_STREQ(gate_.status().detail, "the button");
  EXPECT_FALSE(gate_.wants_quick_stop()) << "set-points stop it smoothly";
  EXPECT_TRUE(gate_.reset(feedback_, now_));
  EXPECT_EQ(gate_.status().state, GateState::idle);
}

TEST_F(SafetyGateTest, ADriveFaultLatches) {
  get_moving();
  feedback_[1].state = DriveState::fault;
  feedback_[1].fault = "overcurrent";
  cycle(command(1.8, 0));
  EXPECT_EQ(gate_.status().joint, 1);
  EXPECT_STREQ(gate_.status().detail, "overcurrent");
  EXPECT_TRUE(gate_.wants_quick_stop());
  expect_stopped_at_rest(GateReason::drive_fault);
}

TEST_F(SafetyGateTest, ADriveThatFallsSilentLatches) {
  get_moving();
  for (int i = 0; i < 30; ++i) cycle(command(1.8, 0), i < 3);
  EXPECT_EQ(gate_.status().state, GateState::stopped);
  EXPECT_EQ(gate_.status().reason, GateReason::feedback_lost);
}

TEST_F(SafetyGateTest, FeedbackThatIsNoNumberLatches) {
  get_moving();
  now_ = now_ + seconds(kDt);
  for (DriveFeedback& f : feedback_) f.time = now_;
  feedback_[0].position = std::nan("");
  gate_.step(now_, command(1.8, 0), feedback_);
  EXPECT_EQ(gate_.status().reason, GateReason::feedback_not_finite);
}

TEST_F(SafetyGateTest, FrozenFeedbackLatchesBeforeTheFollowingErrorIsUsedUp) {
  engage();
  double stuck = -1;
  for (int i = 0; i < 2000 && gate_.status().state != GateState::stopped; ++i) {
    now_ = now_ + seconds(kDt);
    feedback_[0].time = feedback_[1].time = now_;
    feedback_[1].position = gate_.set_point(1).position;
    gate_.step(now_, command(0.11, 0), feedback_);
    stuck = gate_.set_point(0).position;
  }
  EXPECT_EQ(gate_.status().reason, GateReason::feedback_frozen);
  EXPECT_LT(stuck, 0.2);
}

TEST_F(SafetyGateTest, AJointThatDoesNotFollowLatches) {
  get_moving();
  for (int i = 0; i < 200 && gate_.status().state != GateState::stopped; ++i) {
    now_ = now_ + seconds(kDt);
    feedback_[0] = {now_, feedback_[0].position + 1e-5, 0, DriveState::enabled};
    feedback_[1] = {now_, gate_.set_point(1).position, 0, DriveState::enabled};
    gate_.step(now_, command(1.8, 0), feedback_);
  }
  EXPECT_EQ(gate_.status().reason, GateReason::following_error);
  EXPECT_EQ(gate_.status().joint, 0);
}

TEST_F(SafetyGateTest, ResetNeedsFreshFeedbackWithinTheLimits) {
  gate_.emergency_stop("test");
  feedback_[0].position = 2.5;
  EXPECT_FALSE(gate_.reset(feedback_, now_));
  EXPECT_EQ(gate_.status().reason, GateReason::stands_out_of_range);
  feedback_[0].position = 0;
  EXPECT_FALSE(gate_.reset(feedback_, now_ + seconds(1)));
  EXPECT_EQ(gate_.status().reason, GateReason::feedback_lost);
  EXPECT_EQ(gate_.status().state, GateState::stopped);
  EXPECT_TRUE(gate_.reset(feedback_, now_));
}

TEST_F(SafetyGateTest, KeepsAllLimitsUnderAnyCommands) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  engage();
  int moved = 0;
  for (int i = 0; i < 100'000; ++i) {
    MotionCommand c = command(3 * unit(random), 2 * unit(random), random() % 50 != 0);
    switch (random() % 16) {
      case 0: c.position[random() % 2] = std::nan(""); break;
      case 1: c.time = {static_cast<std::int64_t>(random())}; break;
      case 2: c.sequence = random() % (sequence_ + 1); break;
      case 3: c.operator_id = random() % 9; break;
      case 4: c.joints = random() % 20; break;
      default: break;
    }
    if (random() % 3000 == 0) {
      gate_.emergency_stop("random");
    } else if (random() % 500 == 0) {
      gate_.reset(feedback_, now_);
    }
    cycle(random() % 10 == 0 ? std::nullopt : std::optional(c));
    moved += gate_.set_point(0).velocity != 0;
  }
  EXPECT_GT(moved, 5'000);
}

TEST(GateOptions, RefusesWhatContradictsItself) {
  const auto expect_refused = [](auto change, const char* words) {
    GateOptions options = two_joints();
    change(options);
    try {
      options.validate("rig.yaml");
      ADD_FAILURE() << words;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("rig.yaml"), testing::HasSubstr(words)));
    }
  };
  expect_refused([](GateOptions& o) { std::swap(o.joints[0].limits.min_position, o.joints[0].limits.max_position); },
                 "not below");
  expect_refused([](GateOptions& o) { o.joints[1].limits.jerk = 0; }, "jerk");
  expect_refused([](GateOptions& o) { o.joints[1].limits.velocity = NAN; }, "velocity");
  expect_refused([](GateOptions& o) { o.joints.clear(); }, "0 joints");
  expect_refused([](GateOptions& o) { o.rate_hz = 0; }, "rate_hz");
  expect_refused([](GateOptions& o) { o.joints[0].limits.velocity = 100; }, "following error");
}

}  // namespace
}  // namespace foresight
