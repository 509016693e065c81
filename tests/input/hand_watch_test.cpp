// What a hand may say before it is no longer believed.
#include "input/hand_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace foresight::hand_watch_test {
namespace {

using namespace std::chrono_literals;

class HandWatchTest : public testing::Test {
 protected:
  HandWatch::Verdict judge() { return watch_.judge(now_, state_); }
  HandWatch::Verdict next(const Eigen::Vector3d& position) {
    now_ = now_ + 10ms;
    state_.time = now_;
    state_.T_space_hand.translation() = position;
    return judge();
  }
  static TrackerState tracked(OperatorTime now) {
    TrackerState out;
    out.connected = out.tracked = true;
    out.time = now;
    return out;
  }
  OperatorTime now_{50'000'000'000};
  TrackerState state_ = tracked(now_);
  HandWatch watch_;
};

TEST_F(HandWatchTest, AMovingHandIsBelieved) {
  for (int i = 0; i < 100; ++i) {
    const HandWatch::Verdict verdict = next({0.02 * i, 0, 1});  // 2 m/s
    EXPECT_EQ(verdict.pose, HandFault::none);
    EXPECT_TRUE(verdict.news);
  }
}

TEST_F(HandWatchTest, APoseThatJumpsToZeroIsNot) {
  next({0.1, 0.2, 1});
  EXPECT_EQ(next({0, 0, 0}).pose, HandFault::jumped);
  EXPECT_EQ(next({0, 0, 0}).pose, HandFault::none) << "from there on it may go on";
  state_.T_space_hand.linear() = Eigen::AngleAxisd(1.5, Eigen::Vector3d::UnitX()).toRotationMatrix();
  EXPECT_EQ(next({0, 0, 0}).pose, HandFault::jumped) << "turned";
}

TEST_F(HandWatchTest, ADeviceThatSaysNothingNewIsFrozen) {
  next({0, 0, 1});
  now_ = now_ + 190ms;
  EXPECT_EQ(judge().buttons, HandFault::none);
  now_ = now_ + 20ms;
  EXPECT_EQ(judge().buttons, HandFault::frozen);
  EXPECT_EQ(judge().pose, HandFault::frozen);
  state_.time = now_ - 1s;
  EXPECT_EQ(judge().buttons, HandFault::frozen) << "what comes out of order is no news";
  EXPECT_EQ(next({0, 0, 1}).buttons, HandFault::none);
}

TEST_F(HandWatchTest, InstantsOfAnotherClockAreKnown) {
  state_.time = now_ + 1s;
  EXPECT_EQ(judge().buttons, HandFault::wrong_clock);
  state_.time = {1'700'000'000'000'000'000};
  EXPECT_EQ(judge().buttons, HandFault::wrong_clock) << "unix time";
  now_ = {1'800'000'000'000'000'000};
  state_.time = {5};
  EXPECT_EQ(judge().buttons, HandFault::wrong_clock) << "since its own begin";
  state_.time = now_ - 20ms;
  EXPECT_EQ(judge().buttons, HandFault::none) << "none of these stays";
}

TEST_F(HandWatchTest, WhatIsNoPoseIsNot) {
  for (const double bad : {NAN, INFINITY}) EXPECT_EQ(next({bad, 0, 0}).pose, HandFault::bad_pose);
  state_.T_space_hand.linear() *= 1.1;
  EXPECT_EQ(next({0, 0, 0}).pose, HandFault::bad_pose);
  EXPECT_EQ(judge().buttons, HandFault::none) << "its buttons may still count";
  state_.T_space_hand = Pose::Identity();
  state_.tracked = false;
  EXPECT_EQ(judge().pose, HandFault::tracking_lost);
  state_.connected = false;
  EXPECT_EQ(judge().buttons, HandFault::device_gone);
}

TEST_F(HandWatchTest, InstantsAtTheEndOfTheirRangeDoNoHarm) {
  for (const std::int64_t ns : {std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::min()}) {
    state_.time = {ns};
    EXPECT_EQ(judge().buttons, HandFault::wrong_clock);
  }
}

}  // namespace
}  // namespace foresight::hand_watch_test
