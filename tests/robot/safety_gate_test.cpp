#include "drivers/robot/safety_gate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/error.hpp"
#include "tests/scene/test_run.hpp"

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

// While joint 0 looks for home.
class HomingGateTest : public SafetyGateTest {
 protected:
  void SetUp() override { ASSERT_TRUE(gate_.begin_homing(0, now_)); }
  /// `way`: of joint 0 in a cycle.
  void home(int cycles, double way = 0.0004) {
    for (int i = 0; i < cycles; ++i) {
      now_ = now_ + seconds(kDt);
      feedback_[0] = {now_, feedback_[0].position + way, 0, DriveState::homing};
      feedback_[1].time = now_;
      gate_.step(now_, {}, feedback_);
    }
  }
  void expect_stopped(GateReason reason, int joint) {
    EXPECT_EQ(gate_.status().state, GateState::stopped);
    EXPECT_EQ(gate_.status().reason, reason) << to_string(gate_.status().reason);
    EXPECT_EQ(gate_.status().joint, joint);
    EXPECT_TRUE(gate_.wants_quick_stop()) << "only its drive can stop it";
    EXPECT_FALSE(gate_.has_set_point(0));
  }
};

TEST_F(HomingGateTest, ItMayMoveAndGetANewZero) {
  home(500);
  home(1, -1.5);
  home(10, 0);
  EXPECT_EQ(gate_.status().state, GateState::homing) << to_string(gate_.status().reason);
  gate_.end_homing(feedback_[0], now_);
  EXPECT_EQ(gate_.status().state, GateState::idle);
  EXPECT_EQ(gate_.set_point(0).position, feedback_[0].position);
  EXPECT_TRUE(gate_.has_set_point(0));
}

TEST_F(HomingGateTest, FollowsNobody) {
  for (int i = 0; i < 10; ++i) cycle(command(1, 1, i >= 5), false);
  EXPECT_EQ(gate_.status().state, GateState::homing);
  EXPECT_EQ(gate_.set_point(1).position, 0);
  EXPECT_FALSE(gate_.reset(feedback_, now_));
}

TEST_F(HomingGateTest, ItsOwnFaultStops) {
  home(100);
  feedback_[0].state = DriveState::fault;
  gate_.step(now_, {}, feedback_);
  expect_stopped(GateReason::drive_fault, 0);
}

TEST_F(HomingGateTest, AFaultOfAnotherDriveStops) {
  home(100);
  feedback_[1].state = DriveState::fault;
  gate_.step(now_, {}, feedback_);
  expect_stopped(GateReason::drive_fault, 1);
}

TEST_F(HomingGateTest, AnotherJointThatIsPushedAwayStops) {
  home(100);
  feedback_[1].position = 0.3;
  home(1);
  expect_stopped(GateReason::following_error, 1);
}

TEST_F(HomingGateTest, ABusFaultStops) {
  home(100);
  gate_.bus_fault("bus-off");
  expect_stopped(GateReason::bus_fault, -1);
}

TEST_F(HomingGateTest, AnEmergencyStopIsTheDrivesToFollow) {
  home(100);
  gate_.emergency_stop("test");
  expect_stopped(GateReason::emergency_stop, -1);
}

TEST_F(HomingGateTest, OldFeedbackStops) {
  home(100);
  now_ = now_ + seconds(0.06);
  gate_.step(now_, {}, feedback_);
  expect_stopped(GateReason::feedback_lost, 0);
}

TEST_F(HomingGateTest, AJointThatDoesNotMoveStops) {
  home(100);
  home(260, 0);
  expect_stopped(GateReason::feedback_frozen, 0);
}

TEST_F(HomingGateTest, PositionsThatJumpAboutStop) {
  home(100);
  home(1, 3);
  EXPECT_EQ(gate_.status().state, GateState::homing) << "its new zero";
  home(1, -3);
  expect_stopped(GateReason::feedback_jumps, 0);
}

TEST_F(HomingGateTest, ADriveThatLeavesHomingStops) {
  home(100);
  feedback_[0].state = DriveState::stopping;
  gate_.step(now_, {}, feedback_);
  expect_stopped(GateReason::drive_not_enabled, 0);
}

/// A rod of 0.4 m upright on a plate, that turns about y; the plate's edge is something it must stay clear of.
class ClearanceTest : public testing::Test {
 protected:
  ClearanceTest() {
    const std::string text =
        "<robot name='rod'><link name='base'/><link name='rod'><visual><origin xyz='0 0 0.2'/><geometry>"
        "<box size='0.04 0.04 0.4'/></geometry></visual></link><joint name='turn' type='revolute'>"
        "<parent link='base'/><child link='rod'/><axis xyz='0 1 0'/>"
        "<limit lower='-2' upper='2' effort='1' velocity='1'/></joint>"
        "<link name='flag'><visual><geometry><box size='0.01 0.01 0.01'/></geometry></visual></link>"
        "<joint name='wave' type='revolute'><parent link='base'/><child link='flag'/><origin xyz='0 0 1'/>"
        "<axis xyz='0 0 1'/><limit lower='-2' upper='2' effort='1' velocity='1'/></joint></robot>";
    const auto file = folder_.write("rod.urdf", text);
    shape_.emplace(read_urdf(file, folder_.path()), std::vector<std::string>{"turn", "wave"}, Pose::Identity(), "rig");
    GateOptions options = two_joints();
    options.surroundings.obstacles = {{"shelf", {Eigen::Vector3d(0.3, -1, -1), Eigen::Vector3d(1, 1, 1)}}};
    gate_.emplace(options, &*shape_);
  }
  /// Where the rod begins to be too close to the shelf.
  double edge() {
    double low = 0, high = 2;
    for (int i = 0; i < 60; ++i) {
      const double middle = (low + high) / 2;
      (shape_->obstructed(std::array{middle, 0.0}) ? high : low) = middle;
    }
    return low;
  }
  double margin(double position) {
    std::vector<double> all(shape_->couples());
    shape_->margins(std::array{position, 0.0}, all);
    return *std::min_element(all.begin(), all.end());
  }
  void stand_at(double position) {
    for (DriveFeedback& f : feedback_) f = {now_, 0, 0, DriveState::enabled};
    feedback_[0].position = position;
    ASSERT_TRUE(gate_->reset(feedback_, now_));
    go(position, 0, 1, false);
  }
  void go(double turn, double wave, int cycles, bool deadman = true) {
    for (int i = 0; i < cycles; ++i) {
      now_ = now_ + seconds(kDt);
      for (std::size_t k = 0; k < 2; ++k) feedback_[k] = {now_, gate_->set_point(k).position, 0, DriveState::enabled};
      MotionCommand c{7, ++sequence_, now_, deadman, 2, {turn, wave}};
      gate_->step(now_, {&c, 1}, feedback_);
      fastest_ = std::max(fastest_, std::abs(gate_->set_point(0).velocity));
      least_ = std::min(least_, margin(gate_->set_point(0).position));
    }
  }
  TempFolder folder_;
  std::optional<RobotShape> shape_;
  std::optional<SafetyGate> gate_;
  RobotTime now_{1'000'000'000};
  std::uint64_t sequence_ = 0;
  std::array<DriveFeedback, 2> feedback_;
  double fastest_ = 0, least_ = 1;
};

// As after a stop by the drives' own ramps, which knows nothing of obstacles.
TEST_F(ClearanceTest, FromInsideThereIsAWayOutAndOnlyOut) {
  double inside = edge();
  while (margin(inside) > -0.001) inside += 1e-4;
  stand_at(inside);
  const double began = margin(inside);
  ASSERT_NEAR(began, -0.001, 1e-4);
  go(inside + 0.5, 0, 200);
  EXPECT_EQ(gate_->set_point(0).position, inside) << "not farther in";
  EXPECT_EQ(gate_->status().reason, GateReason::obstructed);
  EXPECT_STREQ(gate_->status().detail, "link 'rod' comes too close to obstacle 'shelf'");
  go(inside, 0.5, 200);
  EXPECT_EQ(gate_->set_point(1).position, 0) << "what leads nowhere stays refused";
  go(0, 0, 5);
  EXPECT_EQ(gate_->status().reason, GateReason::obstructed) << "it says why it is slow";
  for (int i = 0; i < 2000 && margin(gate_->set_point(0).position) < 0; ++i) go(0, 0, 1);
  EXPECT_GE(margin(gate_->set_point(0).position), 0);
  EXPECT_LE(fastest_, 0.101) << "slowly, but for the last cycle";
  EXPECT_GE(least_, began - 1e-9) << "never closer than it stood";
  go(0, 0, 1500);
  EXPECT_EQ(gate_->status().reason, GateReason::none);
  EXPECT_NEAR(gate_->set_point(0).position, 0, 1e-3);
  EXPECT_GT(fastest_, 0.3);
}

TEST_F(ClearanceTest, FromDeepInsideThereIsAWayOutToo) {
  const double inside = edge() + 0.3;
  stand_at(inside);
  go(inside + 0.2, 0, 100);
  EXPECT_EQ(gate_->set_point(0).position, inside);
  go(0, 0, 4000);
  EXPECT_NEAR(gate_->set_point(0).position, 0, 1e-3);
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
