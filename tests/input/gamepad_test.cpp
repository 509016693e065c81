// A gamepad that SDL pretends.
#include "input/gamepad.hpp"

#include <SDL2/SDL.h>
#include <gtest/gtest.h>

namespace foresight::gamepad_test {
namespace {

using namespace std::chrono_literals;

class GamepadTest : public testing::Test {
 protected:
  GamepadTest() { SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER); }
  ~GamepadTest() override {
    unplug();
    SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
  }
  void plug() {
    index_ = SDL_JoystickAttachVirtual(SDL_JOYSTICK_TYPE_GAMECONTROLLER, SDL_CONTROLLER_AXIS_MAX,
                                       SDL_CONTROLLER_BUTTON_MAX, 0);
    ASSERT_GE(index_, 0) << SDL_GetError();
    stick_ = SDL_JoystickOpen(index_);
    ASSERT_NE(stick_, nullptr);
    axis(SDL_CONTROLLER_AXIS_TRIGGERLEFT, -1);
    axis(SDL_CONTROLLER_AXIS_TRIGGERRIGHT, -1);
  }
  void unplug() {
    if (stick_) SDL_JoystickClose(stick_);
    if (index_ >= 0) SDL_JoystickDetachVirtual(index_);
    stick_ = nullptr;
    index_ = -1;
  }
  void axis(SDL_GameControllerAxis which, double share) const {
    SDL_JoystickSetVirtualAxis(stick_, which, static_cast<Sint16>(share * 32767));
  }
  void button(SDL_GameControllerButton which, bool down) const {
    SDL_JoystickSetVirtualButton(stick_, which, down ? 1 : 0);
  }
  TrackerState rounds(Gamepad& pad, int count) {
    TrackerState out;
    for (int i = 0; i < count; ++i) out = pad.read(now_ = now_ + 10ms);
    return out;
  }
  OperatorTime now_{1'000'000'000};
  int index_ = -1;
  SDL_Joystick* stick_ = nullptr;
};

TEST_F(GamepadTest, SticksMoveTheHandAndItsShoulderHoldsTheSwitch) {
  plug();
  Gamepad pad;
  ASSERT_TRUE(rounds(pad, 1).connected);
  EXPECT_NE(pad.name().find("gamepad"), std::string::npos);
  axis(SDL_CONTROLLER_AXIS_LEFTY, -1);
  button(SDL_CONTROLLER_BUTTON_RIGHTSHOULDER, true);
  const TrackerState forward = rounds(pad, 100);
  EXPECT_NEAR(forward.T_space_hand.translation().x(), 0.15, 2e-3);
  EXPECT_TRUE(forward.buttons.held(TrackerButton::deadman));
  EXPECT_TRUE(forward.buttons.held(TrackerButton::clutch));
  axis(SDL_CONTROLLER_AXIS_LEFTY, 0.1);
  button(SDL_CONTROLLER_BUTTON_RIGHTSHOULDER, false);
  const TrackerState at_rest = rounds(pad, 2);
  EXPECT_FALSE(at_rest.buttons.held(TrackerButton::deadman));
  EXPECT_EQ(rounds(pad, 100).T_space_hand.matrix(), at_rest.T_space_hand.matrix()) << "a stick's middle";
  button(SDL_CONTROLLER_BUTTON_LEFTSHOULDER, true);
  axis(SDL_CONTROLLER_AXIS_RIGHTX, -1);
  const TrackerState turned = rounds(pad, 50);
  EXPECT_NEAR(Eigen::AngleAxisd(turned.T_space_hand.linear()).axis().z(), 1, 1e-9) << "to the left";
  axis(SDL_CONTROLLER_AXIS_TRIGGERRIGHT, 1);
  EXPECT_TRUE(rounds(pad, 1).buttons.held(TrackerButton::gripper_close));
}

TEST_F(GamepadTest, UnpluggedWhileDrivingItHasGoneAtOnceAndIsFoundAgain) {
  plug();
  Gamepad pad;
  axis(SDL_CONTROLLER_AXIS_LEFTX, 1);
  button(SDL_CONTROLLER_BUTTON_RIGHTSHOULDER, true);
  const TrackerState driving = rounds(pad, 20);
  ASSERT_TRUE(driving.buttons.held(TrackerButton::deadman));
  unplug();
  const TrackerState gone = rounds(pad, 1);
  EXPECT_FALSE(gone.connected);
  EXPECT_FALSE(gone.tracked);
  EXPECT_FALSE(gone.buttons.held(TrackerButton::deadman));
  EXPECT_NE(std::string(gone.trouble), "");
  EXPECT_EQ(rounds(pad, 100).T_space_hand.matrix(), gone.T_space_hand.matrix()) << "no stale speed goes on";
  plug();
  EXPECT_TRUE(rounds(pad, 2).connected);
}

TEST_F(GamepadTest, SticksOfAPadThatWentOutOfRangeDoNotMoveOn) {
  plug();
  Gamepad pad;
  axis(SDL_CONTROLLER_AXIS_LEFTY, -1);
  const TrackerState moved = rounds(pad, 220);
  EXPECT_NEAR(moved.T_space_hand.translation().x(), 0.15 * 2.0, 0.01);
  EXPECT_EQ(rounds(pad, 300).T_space_hand.matrix(), moved.T_space_hand.matrix());
  axis(SDL_CONTROLLER_AXIS_LEFTY, -0.9);
  EXPECT_NE(rounds(pad, 5).T_space_hand.matrix(), moved.T_space_hand.matrix()) << "it is there after all";
}

TEST_F(GamepadTest, TriggersAndCrossOfAPadThatWentOutOfRangeAreLetGoOf) {
  plug();
  Gamepad pad;
  axis(SDL_CONTROLLER_AXIS_TRIGGERLEFT, 1);
  button(SDL_CONTROLLER_BUTTON_DPAD_LEFT, true);
  button(SDL_CONTROLLER_BUTTON_DPAD_UP, true);
  const TrackerState held = rounds(pad, 150);
  EXPECT_TRUE(held.buttons.held(TrackerButton::gripper_open));
  EXPECT_EQ(held.pan_rate, 1);
  EXPECT_EQ(held.tilt_rate, 1);
  const TrackerState gone = rounds(pad, 100);
  EXPECT_FALSE(gone.buttons.held(TrackerButton::gripper_open)) << "what it holds would fall";
  EXPECT_EQ(gone.pan_rate, 0);
  EXPECT_EQ(gone.tilt_rate, 0);
  button(SDL_CONTROLLER_BUTTON_X, true);
  EXPECT_TRUE(rounds(pad, 2).buttons.held(TrackerButton::gripper_open)) << "it is there after all";
}

TEST_F(GamepadTest, ItsMotorsFeelAContact) {
  struct Motors {
    int low = 0;
    static int run(void* self, Uint16 low, Uint16) {
      static_cast<Motors*>(self)->low = low;
      return 0;
    }
  } motors;
  SDL_VirtualJoystickDesc desc{};
  desc.version = SDL_VIRTUAL_JOYSTICK_DESC_VERSION;
  desc.type = SDL_JOYSTICK_TYPE_GAMECONTROLLER;
  desc.naxes = SDL_CONTROLLER_AXIS_MAX;
  desc.nbuttons = SDL_CONTROLLER_BUTTON_MAX;
  desc.userdata = &motors;
  desc.Rumble = &Motors::run;
  index_ = SDL_JoystickAttachVirtualEx(&desc);
  ASSERT_GE(index_, 0) << SDL_GetError();
  {
    Gamepad pad;
    ASSERT_TRUE(rounds(pad, 1).connected);
    pad.push(now_, {{0, 0, 1}, 0.01, 0});
    EXPECT_NEAR(motors.low, 32767, 2);
    pad.push(now_, {{0, 0, 1}, 5, 0});
    EXPECT_EQ(motors.low, 65535);
    pad.push(now_, {});
    EXPECT_EQ(motors.low, 0);
  }
  unplug();
}

TEST_F(GamepadTest, WhatIsThereIsListed) {
  const std::size_t before = find_gamepads().size();
  plug();
  ASSERT_EQ(find_gamepads().size(), before + 1);
  EXPECT_TRUE(find_gamepads().back().known);
}

TEST_F(GamepadTest, OneThatIsNotThereIsSaidSo) {
  Gamepad pad(7);
  const TrackerState state = rounds(pad, 3);
  EXPECT_FALSE(state.connected);
  EXPECT_NE(std::string(state.cure), "");
  pad.push(now_, {{1, 0, 0}, 0.01, 0});
}

}  // namespace
}  // namespace foresight::gamepad_test
