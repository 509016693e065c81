#include <gmock/gmock.h>

#include <random>

#include "common/error.hpp"
#include "tests/robot/gate_fixture.hpp"

namespace foresight::safety_gate_test {
namespace {

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
  ASSERT_TRUE(gate_.set_points_rest());
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
  EXPECT_TRUE(gate_.set_points_rest());
}

TEST_F(SafetyGateTest, AnEmergencyStopLatchesUntilReset) {
  get_moving();
  gate_.emergency_stop();
  expect_stopped_at_rest(GateReason::emergency_stop);
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

// As after its host was suspended for a while: the drive's own watchdog has stopped it, and nobody has noticed.
TEST_F(SafetyGateTest, WhoEngagesADriveWithoutTorqueMovesNothing) {
  cycle(command(0, 0, false));
  feedback_[1].state = DriveState::disabled;
  cycle(command(1, 0.5));
  EXPECT_EQ(gate_.set_point(0).acceleration, 0);
  expect_stopped_at_rest(GateReason::drive_not_enabled);
  EXPECT_EQ(gate_.set_point(0).position, 0);
}

TEST_F(SafetyGateTest, FeedbackThatIsNoNumberLatches) {
  get_moving();
  now_ = now_ + seconds(kDt);
  for (DriveFeedback& f : feedback_) f.time = now_;
  feedback_[0].position = std::nan("");
  gate_.step(now_, std::array{command(1.8, 0)}, feedback_);
  EXPECT_EQ(gate_.status().reason, GateReason::feedback_not_finite);
}

TEST_F(SafetyGateTest, FrozenFeedbackLatchesBeforeTheFollowingErrorIsUsedUp) {
  engage();
  double stuck = -1;
  for (int i = 0; i < 2000 && gate_.status().state != GateState::stopped; ++i) {
    now_ = now_ + seconds(kDt);
    feedback_[0].time = feedback_[1].time = now_;
    feedback_[1].position = gate_.set_point(1).position;
    gate_.step(now_, std::array{command(0.11, 0)}, feedback_);
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
    gate_.step(now_, std::array{command(1.8, 0)}, feedback_);
  }
  EXPECT_EQ(gate_.status().reason, GateReason::following_error);
  EXPECT_EQ(gate_.status().joint, 0);
}

TEST_F(SafetyGateTest, ResetNeedsFreshFeedbackWithinTheLimits) {
  gate_.emergency_stop();
  feedback_[0].position = 2.5;
  feedback_[0].homed = true;
  EXPECT_FALSE(gate_.reset(feedback_, now_));
  EXPECT_EQ(gate_.status().reason, GateReason::stands_out_of_range);
  feedback_[0].position = 0;
  EXPECT_FALSE(gate_.reset(feedback_, now_ + seconds(1)));
  EXPECT_EQ(gate_.status().reason, GateReason::feedback_lost);
  EXPECT_EQ(gate_.status().state, GateState::stopped);
  EXPECT_TRUE(gate_.reset(feedback_, now_));
  gate_.emergency_stop();
  feedback_[0] = {now_, 2.5, 0, DriveState::enabled};
  EXPECT_TRUE(gate_.reset(feedback_, now_)) << "before it is homed, a drive does not know where its joint stands";
  gate_.emergency_stop();
  feedback_[0].position = std::nan("");
  EXPECT_FALSE(gate_.reset(feedback_, now_));
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
      gate_.emergency_stop();
    } else if (random() % 500 == 0) {
      gate_.reset(feedback_, now_);
    }
    cycle(random() % 10 == 0 ? std::nullopt : std::optional(c));
    moved += gate_.set_point(0).velocity != 0;
  }
  EXPECT_GT(moved, 5'000);
}

TEST_F(SafetyGateTest, AReleasedSwitchEngagesNobodyElse) {
  MotionCommand other = command(1, 0);
  other.operator_id = 8;
  cycle(command(0, 0, false));
  for (int i = 0; i < 100; ++i) {
    other.time = now_;
    ++other.sequence;
    cycle(other);
  }
  EXPECT_EQ(gate_.status().state, GateState::idle) << "operator 7 let go, operator 8 never did";
  EXPECT_EQ(gate_.set_point(0).position, 0);
  engage();
  EXPECT_EQ(gate_.status().operator_id, 7u);
}

TEST_F(SafetyGateTest, WhoPressesWhileAnotherIsInChargeMustLetGoFirst) {
  MotionCommand other = command(-1, 0, false);
  other.operator_id = 8;
  const auto others = [&](bool deadman) {
    other.time = now_;
    other.deadman = deadman;
    ++other.sequence;
    return other;
  };
  cycle(others(false));
  get_moving();
  cycle(others(true));
  EXPECT_EQ(gate_.status().last_dropped, GateReason::second_operator);
  cycle(command(0, 0, false));
  const double stood = gate_.set_point(0).position;
  for (int i = 0; i < 300; ++i) cycle(others(true));
  EXPECT_EQ(gate_.status().state, GateState::idle);
  EXPECT_GE(gate_.set_point(0).position, stood);
  cycle(others(false));
  cycle(others(true));
  EXPECT_EQ(gate_.status().operator_id, 8u);
}

TEST_F(SafetyGateTest, AnOperatorThatStartsAnewCountsAnew) {
  get_moving();
  MotionCommand anew = command(1.8, 0.5);
  anew.session = 1;
  anew.sequence = 1;
  cycle(anew);
  EXPECT_EQ(gate_.status().dropped, 0u);
  EXPECT_EQ(gate_.status().state, GateState::stopping) << "whether its switch is held is not known";
  EXPECT_EQ(gate_.status().reason, GateReason::operator_lost);
  for (int i = 0; i < 300; ++i) {
    anew.time = now_;
    ++anew.sequence;
    cycle(anew);
  }
  EXPECT_EQ(gate_.status().state, GateState::idle) << "not engaged";
  for (const bool held : {false, true}) {
    anew.time = now_;
    ++anew.sequence;
    anew.deadman = held;
    cycle(anew);
  }
  EXPECT_EQ(gate_.status().state, GateState::following);
  EXPECT_EQ(gate_.status().dropped, 0u);
  cycle(command(1, 0));
  EXPECT_EQ(gate_.status().last_dropped, GateReason::out_of_order) << "of the session before";
}

TEST_F(SafetyGateTest, EveryCommandOfACycleIsJudged) {
  get_moving();
  now_ = now_ + seconds(kDt);
  for (std::size_t i = 0; i < 2; ++i) feedback_[i] = {now_, gate_.set_point(i).position, 0, DriveState::enabled};
  const std::array all{command(1.8, 0), command(1.8, 0, false), command(1.8, 0)};
  gate_.step(now_, all, feedback_);
  EXPECT_EQ(gate_.status().reason, GateReason::deadman_released) << "though it was pressed again at once";
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
}  // namespace foresight::safety_gate_test
