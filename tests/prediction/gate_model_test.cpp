// The model of the gate against the real one, set-point by set-point.
#include "prediction/gate_model.hpp"

#include <gtest/gtest.h>

#include <random>

#include "drivers/robot/safety_gate.hpp"
#include "tests/prediction/rod.hpp"

namespace foresight::gate_model_test {
namespace {

constexpr Duration kCycle = std::chrono::milliseconds(4);

/// The real gate with drives that do what they are told, fed as operators/line_operator does.
class RealGate {
 public:
  explicit RealGate(const Rod& rod) : shape_(rod.shape()), gate_(rod.options(), shape_.get()) {}

  void stand(RobotTime now) {
    for (DriveFeedback& f : feedback_) f = {now, 0, 0, DriveState::enabled};
    ASSERT_TRUE(gate_.reset(feedback_, now));
  }
  void take(const SentSetPoint& set_point) { newest_ = set_point; }
  void cycle(RobotTime now) {
    for (std::size_t i = 0; i < 2; ++i) feedback_[i] = {now, gate_.set_point(i).position, 0, DriveState::enabled};
    MotionCommand command{7, ++sequence_, now, newest_.deadman, 2, newest_.position};
    const bool lasts = newest_.number != 0 && now <= newest_.sent + newest_.lasts;
    command.time = std::min(now, newest_.sent + newest_.lasts - seconds(gate_.options().command_age_s));
    gate_.step(now, {&command, lasts ? 1u : 0u}, feedback_);
  }
  const SafetyGate& gate() const { return gate_; }

 private:
  std::unique_ptr<RobotShape> shape_;
  SafetyGate gate_;
  std::array<DriveFeedback, 2> feedback_;
  SentSetPoint newest_;
  std::uint64_t sequence_ = 0;
};

GateDoing as_doing(GateState state) {
  return state == GateState::idle        ? GateDoing::idle
         : state == GateState::following ? GateDoing::following
                                         : GateDoing::stopping;
}

struct Counts {
  int following = 0, blocked = 0, losses = 0, stops = 0;
};

// Goals near and far, inside of the obstacle and out of range; releases, presses, and silence in which all expires.
Counts compare(unsigned seed) {
  const Rod rod;
  RealGate real(rod);
  const auto shape = rod.shape();
  GateModel model(rod.options(), shape.get());
  std::mt19937 random(seed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  RobotTime now{1'000'000'000};
  real.stand(now);
  GateModel::State state;
  state.time = now;
  state.doing = GateDoing::idle;
  model.set(state);
  Counts counts;
  std::uint64_t number = 0;
  JointValues goal{};
  int pressed_for = 0, silent_for = 0, open_for = 20;
  for (int i = 0; i < 5000; ++i) {
    now = now + kCycle;
    if (uniform(0, 1) < 0.01) goal = {uniform(-2.1, 2.1), uniform(-1.05, 1.05)};
    if (silent_for == 0 && uniform(0, 1) < 0.003) silent_for = static_cast<int>(uniform(1, 120));
    if (open_for == 0 && uniform(0, 1) < 0.003) open_for = static_cast<int>(uniform(1, 100));
    if (silent_for > 0) {
      --silent_for;
    } else if (i % 2 == 0) {
      SentSetPoint sent{
          ++number, now - std::chrono::milliseconds(100), std::chrono::milliseconds(250), open_for == 0, 2, goal};
      real.take(sent);
      model.take(sent, now);
      pressed_for += open_for == 0 ? 1 : 0;
    }
    if (open_for > 0) --open_for;
    const GateDoing before = model.state().doing;
    real.cycle(now);
    model.cycle(now);
    const GateStatus status = real.gate().status();
    EXPECT_EQ(as_doing(status.state), model.state().doing) << seed << ", cycle " << i;
    EXPECT_EQ(status.reason == GateReason::obstructed && status.state == GateState::following, model.state().blocked)
        << i;
    for (std::size_t k = 0; k < 2; ++k) {
      const JointMotion &is = real.gate().set_point(k), &expected = model.state().motion[k];
      EXPECT_EQ(is.position, expected.position) << seed << ", cycle " << i;
      EXPECT_EQ(is.velocity, expected.velocity) << seed << ", cycle " << i;
    }
    if (testing::Test::HasFailure()) return counts;
    counts.following += model.state().doing == GateDoing::following ? 1 : 0;
    counts.blocked += model.state().blocked ? 1 : 0;
    counts.losses += before == GateDoing::following && status.reason == GateReason::operator_lost &&
                             model.state().doing == GateDoing::stopping
                         ? 1
                         : 0;
    counts.stops += before == GateDoing::stopping && model.state().doing == GateDoing::idle ? 1 : 0;
  }
  return counts;
}

TEST(GateModel, DoesWhatTheGateDoesBitForBit) {
  Counts all;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const Counts one = compare(seed);
    if (HasFailure()) return;
    all.following += one.following;
    all.blocked += one.blocked;
    all.losses += one.losses;
    all.stops += one.stops;
  }
  EXPECT_GT(all.following, 5000);
  EXPECT_GT(all.blocked, 50) << "the obstacle stops the model where it stops the robot";
  EXPECT_GT(all.losses, 3) << "expired set-points are not executed";
  EXPECT_GT(all.stops, 8);
}

/// A robot at rest whose end of a line asks for consent 7, and somebody who sends it set-points.
class AsksForConsent : public testing::Test {
 protected:
  AsksForConsent() {
    GateModel::State state;
    state.time = now_;
    state.doing = GateDoing::idle;
    state.consent = 7;
    model_.set(state);
  }
  /// 0.2 s.
  GateDoing send(bool deadman, std::uint64_t consent) {
    for (int i = 0; i < 50; ++i) cycle(deadman, 0, consent);
    return model_.state().doing;
  }
  /// With a set-point that was sent `age` seconds ago.
  void cycle(bool deadman, double age, std::uint64_t consent) {
    now_ = now_ + kCycle;
    const auto lasts = std::chrono::milliseconds(100);
    model_.take({++number_, now_ - seconds(age), lasts, deadman, 2, {0.5, 0.3}, consent}, now_);
    model_.cycle(now_);
  }
  void wait(double time) {
    for (const RobotTime end = now_ + seconds(time); now_ < end;) model_.cycle(now_ = now_ + kCycle);
  }
  Rod rod_;
  std::unique_ptr<RobotShape> shape_ = rod_.shape();
  GateModel model_{rod_.options(), shape_.get()};
  RobotTime now_{1'000'000'000};
  std::uint64_t number_ = 0;
};

TEST_F(AsksForConsent, FollowsWhoeverLetGoAndAgrees) {
  EXPECT_EQ(send(true, 7), GateDoing::idle) << "the open switch was not seen";
  send(false, 0);
  EXPECT_EQ(send(true, 7), GateDoing::following);
}

TEST_F(AsksForConsent, APressThatMayNotMoveItDoesNotLaterEither) {
  send(false, 0);
  EXPECT_EQ(send(true, 6), GateDoing::idle);
  EXPECT_EQ(send(true, 7), GateDoing::idle) << "the switch has to be opened first";
  send(false, 0);
  EXPECT_EQ(send(true, 7), GateDoing::following);
}

TEST_F(AsksForConsent, APressWhileItSlowsDownCountsForNothing) {
  send(false, 0);
  send(true, 7);
  cycle(false, 0, 0);
  ASSERT_EQ(model_.state().doing, GateDoing::stopping);
  for (int i = 0; i < 10; ++i) EXPECT_NE(send(true, 7), GateDoing::following);
  EXPECT_EQ(model_.state().doing, GateDoing::idle);
}

TEST_F(AsksForConsent, WhatWasLostNeedsAnotherConsent) {
  send(false, 0);
  ASSERT_EQ(send(true, 7), GateDoing::following);
  wait(2);
  ASSERT_EQ(model_.state().doing, GateDoing::idle);
  send(false, 0);
  EXPECT_EQ(send(true, 7), GateDoing::idle) << "it was given before the loss";
  GateModel::State told = model_.state();
  told.consent = 8;
  model_.set(told);
  send(false, 0);
  EXPECT_EQ(send(true, 8), GateDoing::following);
}

TEST_F(AsksForConsent, OneLossAsksForOneOtherConsent) {
  send(false, 0);
  ASSERT_EQ(send(true, 7), GateDoing::following);
  wait(2);
  ASSERT_EQ(model_.state().consent, 0U);
  GateModel::State told = model_.state();
  told.consent = 8;
  model_.set(told);
  wait(1);
  EXPECT_EQ(model_.state().consent, 8U) << "what had expired before it was told is no other loss";
}

TEST_F(AsksForConsent, AnOpenSwitchStopsItHoweverLateThatIsKnown) {
  send(false, 0);
  ASSERT_EQ(send(true, 7), GateDoing::following);
  cycle(false, 0.5, 0);
  EXPECT_NE(model_.state().doing, GateDoing::following);
  EXPECT_FALSE(model_.state().released) << "only what is known in time counts as let go";
}

}  // namespace
}  // namespace foresight::gate_model_test
