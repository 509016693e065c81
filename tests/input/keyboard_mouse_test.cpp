// Keys and the mouse as a window tells of them.
#include "input/keyboard_mouse.hpp"

#include <gtest/gtest.h>

#include <set>

namespace foresight::keyboard_mouse_test {
namespace {

using namespace std::chrono_literals;

class KeyboardMouseTest : public testing::Test {
 protected:
  /// A round of the window, 10 ms later.
  TrackerState round(bool looks = true) {
    now_ = now_ + 10ms;
    if (looks) device_.looked(now_);
    return device_.read(now_);
  }
  TrackerState rounds(int count, bool looks = true) {
    TrackerState out;
    for (int i = 0; i < count; ++i) out = round(looks);
    return out;
  }
  OperatorTime now_{1'000'000'000};
  KeyboardMouse device_;
};

TEST_F(KeyboardMouseTest, EveryKeyIsNamedOnceAndFound) {
  std::set<int> codes;
  std::set<std::string> names;
  for (const KeyBinding& binding : key_bindings()) {
    EXPECT_TRUE(codes.insert(binding.code).second) << binding.printed;
    EXPECT_TRUE(names.insert(binding.printed).second) << binding.printed;
    EXPECT_EQ(hand_key(binding.code), binding.key) << binding.printed;
    EXPECT_NE(std::string(binding.does), "");
  }
  EXPECT_EQ(codes.size(), kHandKeys);
  EXPECT_FALSE(hand_key(-1));
}

TEST_F(KeyboardMouseTest, KeysMoveAtABoundedSpeedAndOnlyWhileTheyAreDown) {
  round();
  device_.key(HandKey::forward, true);
  device_.key(HandKey::up, true);
  const TrackerState moved = rounds(100);
  EXPECT_NEAR(moved.T_space_hand.translation().norm(), 0.15, 1e-9);
  EXPECT_GT(moved.T_space_hand.translation().x(), 0.1);
  EXPECT_GT(moved.T_space_hand.translation().z(), 0.1);
  device_.key(HandKey::forward, false);
  device_.key(HandKey::up, false);
  EXPECT_EQ(rounds(100).T_space_hand.matrix(), moved.T_space_hand.matrix());
}

TEST_F(KeyboardMouseTest, TheSwitchIsAKeyOrTheMousesButton) {
  EXPECT_FALSE(round().buttons.held(TrackerButton::deadman));
  device_.key(HandKey::deadman, true);
  EXPECT_TRUE(round().buttons.held(TrackerButton::deadman));
  device_.key(HandKey::deadman, false);
  device_.mouse_button(KeyboardMouse::MouseButton::left, true);
  EXPECT_TRUE(rounds(2).buttons.held(TrackerButton::clutch));
}

// Who let go and pressed again within one picture has let go: a switch that no longer counted counts.
TEST_F(KeyboardMouseTest, LettingGoBetweenTwoReadsIsNotLost) {
  device_.key(HandKey::deadman, true);
  ASSERT_TRUE(rounds(2).buttons.held(TrackerButton::deadman));
  device_.key(HandKey::deadman, false);
  device_.key(HandKey::deadman, true);
  EXPECT_FALSE(round().buttons.held(TrackerButton::deadman));
  EXPECT_TRUE(round().buttons.held(TrackerButton::deadman));
  device_.mouse_button(KeyboardMouse::MouseButton::left, true);
  device_.key(HandKey::deadman, false);
  device_.key(HandKey::forward, true);
  EXPECT_TRUE(round().buttons.held(TrackerButton::deadman)) << "by one of the two all the time";
  device_.focus_lost();
  device_.key(HandKey::deadman, true);
  EXPECT_FALSE(round().buttons.held(TrackerButton::deadman));
  EXPECT_TRUE(round().buttons.held(TrackerButton::deadman));
}

// Both ends of a short press come at once from a window that draws slowly.
TEST_F(KeyboardMouseTest, AShortPressOfAKeyThatChangesSomethingIsNotLost) {
  const std::pair<HandKey, TrackerButton> keys[] = {{HandKey::joint_mode, TrackerButton::joint_mode},
                                                    {HandKey::recentre, TrackerButton::recentre},
                                                    {HandKey::home_view, TrackerButton::home_view}};
  for (const auto& [key, button] : keys) {
    round();
    device_.key(key, true);
    device_.key(key, false);
    EXPECT_TRUE(round().buttons.held(button));
    EXPECT_FALSE(round().buttons.held(button)) << "once";
    device_.key(key, true);
    EXPECT_TRUE(rounds(3).buttons.held(button));
    device_.key(key, false);
    EXPECT_FALSE(round().buttons.held(button));
  }
  device_.key(HandKey::deadman, true);
  device_.key(HandKey::deadman, false);
  EXPECT_FALSE(round().buttons.held(TrackerButton::deadman)) << "a switch counts while it is held";
  device_.key(HandKey::joint_mode, true);
  device_.focus_lost();
  EXPECT_FALSE(round().buttons.held(TrackerButton::joint_mode));
}

TEST_F(KeyboardMouseTest, AWindowThatLosesTheKeyboardLetsGoOfAll) {
  device_.key(HandKey::deadman, true);
  device_.key(HandKey::left, true);
  const TrackerState before = rounds(5);
  ASSERT_TRUE(before.buttons.held(TrackerButton::deadman));
  device_.focus_lost();
  const TrackerState after = rounds(50);
  EXPECT_FALSE(after.buttons.held(TrackerButton::deadman));
  EXPECT_EQ(after.T_space_hand.matrix(), before.T_space_hand.matrix());
}

TEST_F(KeyboardMouseTest, AWindowThatHangsLetsGoOfAll) {
  device_.key(HandKey::deadman, true);
  device_.key(HandKey::right, true);
  ASSERT_TRUE(rounds(5).buttons.held(TrackerButton::deadman));
  const TrackerState hung = rounds(60, false), later = rounds(60, false);
  EXPECT_FALSE(hung.buttons.held(TrackerButton::deadman));
  EXPECT_EQ(later.T_space_hand.matrix(), hung.T_space_hand.matrix()) << "no key moves on for ever";
  EXPECT_FALSE(rounds(5).buttons.held(TrackerButton::deadman)) << "what was held has to be pressed again";
}

TEST_F(KeyboardMouseTest, TellsOfASwitchThatWasHeldInVain) {
  round();
  rounds(60, false);
  round();
  EXPECT_FALSE(device_.held_in_vain(now_)) << "no switch was held while the window did not look";
  device_.key(HandKey::deadman, true);
  rounds(5);
  rounds(20, false);
  round();
  EXPECT_FALSE(device_.held_in_vain(now_)) << "0.2 s: it counted all the time";
  rounds(39, false);
  round();
  EXPECT_EQ(device_.held_in_vain(now_), 400ms);
  device_.key(HandKey::deadman, false);
  rounds(390);
  EXPECT_EQ(device_.held_in_vain(now_), 400ms);
  rounds(20);
  EXPECT_FALSE(device_.held_in_vain(now_));
}

TEST_F(KeyboardMouseTest, TellsItForAsLongAsTheSwitchIsHeldOnInVain) {
  const auto hold_in_vain = [&](auto press) {
    round();
    press(true);
    rounds(5);
    rounds(40, false);
    const TrackerState later = rounds(1000);
    EXPECT_FALSE(later.buttons.held(TrackerButton::deadman)) << "it does not count again by itself";
    EXPECT_TRUE(device_.held_in_vain(now_));
  };
  const auto press_key = [&](bool down) { device_.key(HandKey::deadman, down); };
  const auto press_mouse = [&](bool down) { device_.mouse_button(KeyboardMouse::MouseButton::left, down); };
  hold_in_vain(press_key);
  press_key(false);
  EXPECT_FALSE(device_.held_in_vain(now_));
  press_key(true);
  EXPECT_TRUE(rounds(5).buttons.held(TrackerButton::deadman));
  press_key(false);
  hold_in_vain(press_mouse);
  press_mouse(false);
  EXPECT_FALSE(device_.held_in_vain(now_));
  hold_in_vain(press_key);
  device_.focus_lost();
  EXPECT_FALSE(device_.held_in_vain(now_)) << "nobody would tell that it was let go of";
}

// Windows tell of the mouse's buttons in every round.
TEST_F(KeyboardMouseTest, AMouseButtonThatStayedDownDoesNotCountAgainByItself) {
  const auto round_with_button = [&](bool down) {
    device_.mouse_button(KeyboardMouse::MouseButton::left, down);
    return round().buttons.held(TrackerButton::deadman);
  };
  round();
  ASSERT_TRUE(round_with_button(true));
  rounds(60, false);
  for (int i = 0; i < 50; ++i) EXPECT_FALSE(round_with_button(true)) << i;
  EXPECT_FALSE(round_with_button(false));
  EXPECT_TRUE(round_with_button(true));
  device_.focus_lost();
  EXPECT_FALSE(round_with_button(true)) << "the window has come back";
}

TEST_F(KeyboardMouseTest, TheMouseMovesTheHandNoFasterThanKeysAndNotForLong) {
  round();
  device_.mouse_moved(100, 0);
  EXPECT_EQ(rounds(10).T_space_hand.translation().norm(), 0) << "without its button";
  device_.mouse_button(KeyboardMouse::MouseButton::left, true);
  device_.mouse_moved(10, -4);
  const Eigen::Vector3d there = rounds(20).T_space_hand.translation();
  EXPECT_NEAR(there.y(), -0.005, 1e-9) << "to the right";
  EXPECT_NEAR(there.z(), 0.002, 1e-9) << "and up";
  device_.mouse_moved(1e6, 0);
  const TrackerState one = round();
  EXPECT_LE((one.T_space_hand.translation() - there).norm(), 0.15 * 0.01 + 1e-12);
  EXPECT_NEAR((rounds(100).T_space_hand.translation() - there).norm(), 0.015, 1e-6) << "a tenth of a second of it";
}

TEST_F(KeyboardMouseTest, JointsAreChosenByNumberAndMovedByKeys) {
  device_.key(HandKey::joint_4, true);
  EXPECT_EQ(round().joint, 3u);
  EXPECT_FALSE(round().joint) << "once";
  device_.key(HandKey::joint_less, true);
  device_.key(HandKey::slow, true);
  EXPECT_NEAR(round().joint_rate, -0.2, 1e-12);
}

}  // namespace
}  // namespace foresight::keyboard_mouse_test
