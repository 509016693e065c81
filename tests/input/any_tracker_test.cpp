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
    if (says_more) state.time = now;
    return state;
  }
  TrackerState state;
  bool says_more = true;
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

TEST_F(AnyTrackerTest, FromOneThatIsFrozenALivingOneTakesOver) {
  press(pad_, true);
  read();
  ASSERT_TRUE(drives(1));
  pad_.says_more = false;
  for (int i = 0; i < 15; ++i) read();
  press(keys_, true);
  for (int i = 0; i < 15; ++i) {
    read();
    EXPECT_EQ(any_.in_charge(), &pad_) << "it had been silent for no longer than 200 ms then";
  }
  press(keys_, false);
  read();
  press(keys_, true);
  EXPECT_FALSE(read().buttons.held(TrackerButton::deadman)) << "its pose comes with an open switch first";
  EXPECT_TRUE(drives(0));
  pad_.says_more = true;
  press(keys_, false);
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(read().buttons.held(TrackerButton::deadman)) << "the other held it before";
}

// It comes with new instants, but nobody can be so still.
TEST_F(AnyTrackerTest, FromAHandThatDoesNotStirAtAllAnotherTakesOver) {
  for (const bool made_of_speeds : {false, true}) {
    pad_.state.integrated = made_of_speeds;
    press(pad_, true);
    read();
    ASSERT_TRUE(drives(1));
    for (int i = 0; i < 50; ++i) read();
    press(keys_, true);
    read();
    EXPECT_TRUE(drives(1)) << "half a second is not long";
    press(keys_, false);
    for (int i = 0; i < 80; ++i) read();
    EXPECT_TRUE(drives(1)) << "while nobody else wants to drive";
    press(keys_, true);
    read();
    EXPECT_EQ(drives(0), !made_of_speeds) << "nobody deflects a stick that rests";
    press(keys_, false);
    press(pad_, false);
    read();
  }
}

TEST_F(AnyTrackerTest, OneThatGoesIsNotReplacedWithoutAPress) {
  press(pad_, true);
  read();
  ASSERT_TRUE(drives(1));
  press(keys_, true);
  read();
  pad_.state.connected = false;
  EXPECT_FALSE(read().connected) << "which ends the motion";
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(read().buttons.held(TrackerButton::deadman));
  pad_.state.connected = true;
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(read().buttons.held(TrackerButton::deadman)) << "came with its switch held";
}

TEST_F(AnyTrackerTest, OneThatWentWhileItDroveIsNamedUntilItIsBackOrAnotherIsPressed) {
  for (const bool comes_back : {true, false}) {
    press(pad_, true);
    read();
    ASSERT_TRUE(drives(1));
    EXPECT_TRUE(any_.missing().empty());
    pad_.state = TrackerState{};
    pad_.state.trouble = "unplugged";
    pad_.state.cure = "plug it in";
    for (int i = 0; i < 50; ++i) {
      EXPECT_STREQ(read().trouble, "unplugged");
      ASSERT_EQ(any_.missing().size(), 1u);
      EXPECT_TRUE(any_.missing()[0].drove);
      EXPECT_EQ(any_.missing()[0].device, &pad_);
      EXPECT_STREQ(any_.missing()[0].cure, "plug it in");
    }
    if (!comes_back) {
      press(keys_, true);
      read();
      EXPECT_TRUE(drives(0));
    }
    ASSERT_EQ(any_.missing().size(), 1u);
    EXPECT_EQ(any_.missing()[0].drove, comes_back) << "somebody else drives: it is missing all the same";
    pad_.state = keys_.state;
    press(pad_, false);
    pad_.state.T_space_hand.translation().x() = 1;
    EXPECT_STREQ(read().trouble, "");
    EXPECT_TRUE(any_.missing().empty());
  }
}

// The two controllers of a head display are one device at the seat.
TEST_F(AnyTrackerTest, OneOfSeveralWithinOneIsNamedToo) {
  GivenTracker left, right;
  left.state = right.state = keys_.state;
  AnyTracker hands({&left, &right});
  AnyTracker any({&keys_, &hands});
  const auto reads = [&](int count) {
    for (int i = 0; i < count; ++i) any.read(now_ = now_ + 10ms);
  };
  reads(1);
  press(left, true);
  reads(3);
  left.state = TrackerState{};
  left.state.trouble = "the controller is off";
  reads(20);
  ASSERT_EQ(any.missing().size(), 1u);
  EXPECT_TRUE(any.missing()[0].drove);
  EXPECT_STREQ(any.missing()[0].trouble, "the controller is off");
  press(right, true);
  reads(3);
  EXPECT_EQ(any.in_charge(), &hands);
  EXPECT_TRUE(any.missing().empty()) << "one of them is enough";
}

TEST_F(AnyTrackerTest, OneThatIsNotThereIsMissingOnceItWasAskedFor) {
  pad_.state = TrackerState{};
  AnyTracker fresh({&keys_, &pad_});
  EXPECT_TRUE(fresh.missing().empty()) << "nobody has looked";
  fresh.read(now_);
  ASSERT_EQ(fresh.missing().size(), 1u);
  EXPECT_FALSE(fresh.missing()[0].drove);
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

TEST_F(AnyTrackerTest, NobodyListensToOneThatIsFrozen) {
  pad_.state.buttons.set(TrackerButton::home_view);
  pad_.state.pan_rate = 0.5;
  EXPECT_EQ(read().pan_rate, 0.5);
  pad_.says_more = false;
  for (int i = 0; i < 25; ++i) read();
  const TrackerState state = read();
  EXPECT_EQ(state.pan_rate, 0) << "the camera would turn until it came back";
  EXPECT_FALSE(state.buttons.held(TrackerButton::home_view));
  pad_.says_more = true;
  EXPECT_EQ(read().pan_rate, 0.5);
}

TEST_F(AnyTrackerTest, OneThatIsFrozenMakesNobodyElseOld) {
  press(pad_, true);
  read();
  press(pad_, false);
  read();
  pad_.says_more = false;
  for (int i = 0; i < 25; ++i) read();
  keys_.state.tilt_rate = -0.5;
  const TrackerState state = read();
  EXPECT_EQ(state.time, now_) << "what is as old as the frozen one counts for nothing";
  EXPECT_EQ(state.tilt_rate, -0.5);
}

}  // namespace
}  // namespace foresight::any_tracker_test
