#include "display/head/head_hands.hpp"

#include <limits>

#include "display/head/controllers.hpp"
#include "input/hand_watch.hpp"

namespace foresight::head_hands_test {
namespace {

using namespace std::chrono_literals;

TrackerState squeezing(OperatorTime time, bool held) {
  TrackerState out;
  out.connected = out.tracked = true;
  out.time = time;
  out.buttons.set(TrackerButton::deadman, held);
  return out;
}

TEST(HeadHands, WhoeverSqueezesFirstIsInCharge) {
  const auto held = std::make_shared<head::HeldControllers>();
  head::HeadHands hands(held);
  OperatorTime now{1'000'000'000};
  EXPECT_FALSE(hands.read(now).connected);
  EXPECT_STRNE(hands.read(now).trouble, "");
  const auto say = [&](bool left, bool right) {
    now = now + 11ms;
    held->hands[0].say(squeezing(now, left));
    held->hands[1].say(squeezing(now, right));
    return hands.read(now);
  };
  say(false, false);
  say(false, true);
  EXPECT_TRUE(say(true, true).buttons.held(TrackerButton::deadman));
  EXPECT_EQ(hands.name(), "right controller");
  EXPECT_FALSE(say(true, false).buttons.held(TrackerButton::deadman)) << "the left one held it before";
}

TEST(HeadHands, AHeadsetThatHasGoneTakesThemAlong) {
  const auto held = std::make_shared<head::HeldControllers>();
  head::HeadHands hands(held);
  OperatorTime now{1'000'000'000};
  held->hands[1].say(squeezing(now, false));
  hands.read(now);
  held->hands[1].say(squeezing(now, true));
  ASSERT_TRUE(hands.read(now).buttons.held(TrackerButton::deadman));
  held->gone("gone", "plug it in");
  const TrackerState state = hands.read(now + 5ms);
  EXPECT_FALSE(state.connected);
  EXPECT_FALSE(state.buttons.held(TrackerButton::deadman));
  EXPECT_STREQ(state.trouble, "gone");
}

// A runtime that stands still renews nothing.
TEST(HeadHands, WhatIsNotRenewedGrowsOld) {
  const auto held = std::make_shared<head::HeldControllers>();
  head::HeadHands hands(held);
  HandWatch watch;
  const OperatorTime now{1'000'000'000};
  held->hands[0].say(squeezing(now, true));
  EXPECT_EQ(watch.judge(now + 10ms, hands.read(now + 10ms)).buttons, HandFault::none);
  EXPECT_EQ(watch.judge(now + 250ms, hands.read(now + 250ms)).buttons, HandFault::frozen);
}

TEST(HeadHands, ASqueezeDoesNotFlutter) {
  EXPECT_FALSE(head::squeezed(0.5, false));
  EXPECT_TRUE(head::squeezed(0.5, true));
  EXPECT_TRUE(head::squeezed(1, false));
  EXPECT_FALSE(head::squeezed(0.3, true));
  EXPECT_FALSE(head::squeezed(std::numeric_limits<double>::quiet_NaN(), true));
}

}  // namespace
}  // namespace foresight::head_hands_test
