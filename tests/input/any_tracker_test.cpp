// Several devices, one in charge.
#include "input/any_tracker.hpp"

#include <gtest/gtest.h>

namespace foresight::any_tracker_test {
namespace {

using namespace std::chrono_literals;

class GivenTracker final : public Tracker {
 public:
  std::string name() const override { return "given"; }
  TrackerState read(OperatorTime now) noexcept override {
    state.time = now;
    return state;
  }
  TrackerState state;
};

class AnyTrackerTest : public testing::Test {
 protected:
  AnyTrackerTest() {
    for (GivenTracker* device : {&keys_, &pad_}) device->state.connected = device->state.tracked = true;
    pad_.state.T_space_hand.translation().x() = 1;
    read();
  }
  static void press(GivenTracker& device, bool down) { device.state.buttons.set(TrackerButton::deadman, down); }
  TrackerState read() { return any_.read(now_ = now_ + 10ms); }
  bool drives(double x) {
    const TrackerState state = read();
    return state.buttons.held(TrackerButton::deadman) && state.T_space_hand.translation().x() == x;
  }
  GivenTracker keys_, pad_;
  AnyTracker any_{{&keys_, &pad_}};
  OperatorTime now_{1'000'000'000};
};

TEST_F(AnyTrackerTest, WhoPressesFirstIsInChargeUntilItLetsGo) {
  press(pad_, true);
  EXPECT_FALSE(read().buttons.held(TrackerButton::deadman)) << "its pose comes with an open switch first";
  EXPECT_TRUE(drives(1));
  press(keys_, true);
  EXPECT_TRUE(drives(1));
  press(pad_, false);
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(read().buttons.held(TrackerButton::deadman)) << "held before";
  press(keys_, false);
  read();
  press(keys_, true);
  read();
  EXPECT_TRUE(drives(0));
}

TEST_F(AnyTrackerTest, OneThatGoesIsNotReplacedWithoutAPress) {
  press(pad_, true);
  read();
  ASSERT_TRUE(drives(1));
  press(keys_, true);
  read();
  pad_.state.connected = false;
  EXPECT_FALSE(read().connected) << "it has to be said";
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(read().buttons.held(TrackerButton::deadman));
  pad_.state.connected = true;
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(read().buttons.held(TrackerButton::deadman)) << "came with its switch held";
}

TEST_F(AnyTrackerTest, OneThatIsNotThereKeepsNobodyAway) {
  keys_.state = TrackerState{};
  read();
  EXPECT_TRUE(read().connected);
  press(pad_, true);
  read();
  EXPECT_TRUE(drives(1));
}

TEST_F(AnyTrackerTest, ViewsListenToAll) {
  press(pad_, true);
  keys_.state.buttons.set(TrackerButton::home_view);
  keys_.state.buttons.set(TrackerButton::gripper_open);
  keys_.state.pan_rate = 0.5;
  read();
  const TrackerState state = read();
  EXPECT_TRUE(state.buttons.held(TrackerButton::home_view));
  EXPECT_FALSE(state.buttons.held(TrackerButton::gripper_open)) << "the gripper does not";
  EXPECT_EQ(state.pan_rate, 0.5);
}

}  // namespace
}  // namespace foresight::any_tracker_test
