// Speeds to poses.
#include "input/rate_hand.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace foresight::rate_hand_test {
namespace {

using namespace std::chrono_literals;

constexpr OperatorTime kBegin{9'000'000'000};

TEST(RateHandTest, GoesNoFasterThanItsFullSpeed) {
  RateHand hand({.speed = 0.2, .turn = 0.5});
  hand.step(kBegin, {});
  for (int i = 1; i <= 100; ++i) hand.step(kBegin + i * 10ms, {{1, 1, 1}, {0, 0, 5}});
  EXPECT_NEAR(hand.pose().translation().norm(), 0.2, 1e-9) << "a second, all axes at once";
  EXPECT_NEAR(Eigen::AngleAxisd(hand.pose().linear()).angle(), 0.5, 1e-9);
}

TEST(RateHandTest, AtRestItStaysWhereItIsBitForBit) {
  RateHand hand;
  hand.step(kBegin, {});
  hand.step(kBegin + 10ms, {{0.3, -0.2, 0.1}, {0.1, 0.2, -0.3}});
  const Pose there = hand.pose();
  for (int i = 2; i < 1000; ++i) hand.step(kBegin + i * 10ms, {});
  EXPECT_EQ(hand.pose().matrix(), there.matrix());
}

TEST(RateHandTest, NobodyKnowsWhatItSaidDuringAPause) {
  RateHand hand;
  hand.step(kBegin, {{1, 0, 0}, {}});
  hand.step(kBegin + 3s, {{1, 0, 0}, {}});
  EXPECT_EQ(hand.pose().translation().norm(), 0);
  hand.step(kBegin + 2s, {{1, 0, 0}, {}});
  EXPECT_EQ(hand.pose().translation().norm(), 0) << "time does not go back";
}

TEST(RateHandTest, NumbersThatAreNoneStandForRest) {
  RateHand hand;
  hand.step(kBegin, {});
  hand.step(kBegin + 10ms, {{NAN, 1, 0}, {0, INFINITY, 0}});
  hand.step(kBegin + 20ms, {{1e300, 0, 0}, {0, -1e308, 0}});
  EXPECT_EQ(hand.pose().matrix(), Pose::Identity().matrix());
}

TEST(RateHandTest, ASticksMiddleIsRest) {
  EXPECT_EQ(without_dead_zone(0.1, 0.15), 0);
  EXPECT_EQ(without_dead_zone(NAN, 0.15), 0);
  EXPECT_DOUBLE_EQ(without_dead_zone(-1, 0.15), -1);
  EXPECT_DOUBLE_EQ(without_dead_zone(7, 0.15), 1);
  EXPECT_NEAR(without_dead_zone(0.1501, 0.15), 0, 2e-4) << "and it begins from 0, not with a step";
}

}  // namespace
}  // namespace foresight::rate_hand_test
