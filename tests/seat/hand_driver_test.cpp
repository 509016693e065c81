// A hand at the seat: what it does is what the operator sees it do, in a window or through a head display.
#include "seat/hand_driver.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "input/hand_of_rig.hpp"
#include "session/live_scene.hpp"
#include "tests/support/folders.hpp"

namespace foresight::hand_driver_test {
namespace {

using namespace std::chrono_literals;

/// Says what a test has it say, and keeps what it feels.
class ToldHand final : public Tracker, public ForceSink {
 public:
  std::string name() const override { return "a hand"; }
  TrackerState read(OperatorTime now) noexcept override {
    state.time = now;
    return state;
  }
  void push(OperatorTime, const HandContact& contact) noexcept override { felt = contact; }
  TrackerState state;
  HandContact felt;
};

class HandAtTheSeat : public testing::Test {
 protected:
  HandAtTheSeat() {
    open_driver();
    view_.robot.joints = rig_.joints.size();
    view_.robot.begin = {0.2, 0.6, -0.1, 1.2, 0.3, 0.7, -0.2, 0.03, 0.1, -0.2};
    view_.robot.ready = true;
    cycles(20);
  }
  void open_driver() {
    auto device = std::make_unique<ToldHand>();
    hand_ = device.get();
    hand_->state.connected = hand_->state.tracked = true;
    std::vector<std::unique_ptr<Tracker>> devices;
    devices.push_back(std::move(device));
    driver_.emplace(rig_, std::move(devices), live_scene_of(rig_, true, std::nullopt, false).model());
  }
  /// What is said under that label; "" nothing.
  SeatLine said(const std::string& label) const {
    const std::vector<SeatLine> lines = driver_->lines();
    const auto found = std::ranges::find(lines, label, &SeatLine::label);
    return found != lines.end() ? *found : SeatLine{};
  }
  void hold(bool held) {
    hand_->state.buttons.set(TrackerButton::deadman, held);
    hand_->state.buttons.set(TrackerButton::clutch, held);
  }
  /// The head looks about meanwhile, and the hand goes `by` m each time.
  void cycles(int count, const Eigen::Vector3d& by = Eigen::Vector3d::Zero()) {
    for (int i = 0; i < count; ++i) {
      view_.now = view_.now + 20ms;
      Pose head = Pose::Identity();
      head.linear() = Eigen::AngleAxisd(0.8 * std::sin(0.1 * turns_++), Eigen::Vector3d::UnitZ()).toRotationMatrix();
      hand_->state.T_space_head = head;
      hand_->state.T_space_hand.translation() += by;
      if (window_answers_) driver_->take({}, view_.now);
      wish_ = driver_->tick(view_);
      view_.robot.follows = wish_.deadman;
      if (wish_.deadman) view_.robot.begin = wish_.position;
    }
  }
  Eigen::Vector3d tip_in_world() const {
    const HandOptions options = hand_options(rig_);
    return rig_.T_world_robot * options.arm->tip_pose(joints_of(wish_.position, options.arm_joints)).translation();
  }
  Eigen::Vector3d way_of_the_tool() {
    hold(true);
    cycles(5);
    EXPECT_TRUE(wish_.deadman);
    const Eigen::Vector3d before = tip_in_world();
    cycles(30, {0.001, 0, 0});
    const Eigen::Vector3d out = tip_in_world() - before;
    hold(false);
    cycles(5);
    return out;
  }

  /// The switch is held, and does not count.
  void expect_to_have_to_press_anew() {
    cycles(50, {0.0005, 0, 0});
    EXPECT_FALSE(wish_.deadman) << "it has been held all the time";
    hold(false);
    cycles(5);
    EXPECT_FALSE(wish_.refused);
    hold(true);
    cycles(2);
    EXPECT_TRUE(wish_.deadman);
  }

  Rig rig_ = read_rig(source_folder() / "configs" / "minerva.yaml");
  ToldHand* hand_ = nullptr;
  std::optional<HandDriver> driver_;
  SeatView view_;
  SeatWish wish_;
  int turns_ = 0;
  bool window_answers_ = true;
};

TEST_F(HandAtTheSeat, ThroughAHeadDisplayTheToolGoesAsTheHandIsSeenToGo) {
  for (const double turned : {0.0, 1.2, -2.0}) {
    Pose T_world_space = Pose::Identity();
    T_world_space.linear() = Eigen::AngleAxisd(turned, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    driver_->look_within(T_world_space);
    const Eigen::Vector3d way = way_of_the_tool();
    ASSERT_GT(way.norm(), 0.005);
    EXPECT_GT(way.normalized().dot(T_world_space.linear().col(0)), 0.98)
        << "wherever the head looked: " << way.transpose();
  }
}

TEST_F(HandAtTheSeat, TellsHowLongAKeyTookUntilItIsInASetPoint) {
  EXPECT_FALSE(driver_->input_took());
  driver_->take({}, view_.now + 3ms);
  cycles(1);
  EXPECT_FALSE(driver_->input_took()) << "nothing was pressed";
  gl::WindowInput input;
  input.key_events = {{87, true}};
  driver_->take(input, view_.now + 4ms);
  driver_->take({}, view_.now + 12ms);
  cycles(1);
  EXPECT_EQ(driver_->input_took(), 16ms);
  cycles(3);
  EXPECT_EQ(driver_->input_took(), 16ms);
}

TEST_F(HandAtTheSeat, AnInterruptedHandHasToPressAnew) {
  hold(true);
  cycles(10, {0.0005, 0, 0});
  ASSERT_TRUE(wish_.deadman);
  driver_->interrupt("the headset has gone", "look at the window");
  cycles(1, {0.0005, 0, 0});
  EXPECT_FALSE(wish_.deadman);
  ASSERT_EQ(driver_->lines().size(), 2u);
  EXPECT_EQ(driver_->lines()[0].urgency, Urgency::trouble);
  cycles(5);
  EXPECT_EQ(said("hand").words, "the headset has gone") << "until the switch is let go of";
  EXPECT_TRUE(wish_.refused);
  expect_to_have_to_press_anew();
}

TEST_F(HandAtTheSeat, WhatWasHandedOverIsNotAskedForAgain) {
  view_.control.wanted = true;
  driver_->hand_over();
  cycles(1);
  EXPECT_TRUE(wish_.hand_over && wish_.control);
  cycles(1);
  EXPECT_TRUE(wish_.control) << "nobody had asked for it";
  driver_->hand_over();
  cycles(1);
  view_.control.wanted = false;
  cycles(1);
  EXPECT_FALSE(wish_.control);
  driver_->toggle_control();
  cycles(1);
  EXPECT_TRUE(wish_.control);
}

TEST_F(HandAtTheSeat, WhoDrivesFeelsWhatTheToolLeansOn) {
  Pose level = Pose::Identity();  // a camera that looks along x
  level.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  driver_->look_from(level);
  hold(true);
  cycles(20);
  ASSERT_TRUE(wish_.deadman);
  EXPECT_EQ(hand_->felt.depth, 0);
  cycles(350, {0, 0, -0.002});
  EXPECT_GT(hand_->felt.depth, 0.005) << "m: the hand goes on into the table";
  EXPECT_GT(hand_->felt.out_in_space.z(), 0.9);
  hold(false);
  cycles(3);
  EXPECT_EQ(hand_->felt.depth, 0) << "nobody drives";
}

TEST_F(HandAtTheSeat, NoDeviceDrivesOnBehindAWindowThatHangs) {
  hold(true);
  cycles(10, {0.0005, 0, 0});
  ASSERT_TRUE(wish_.deadman);
  window_answers_ = false;
  cycles(20, {0.0005, 0, 0});
  EXPECT_TRUE(wish_.deadman) << "0.4 s: a slow picture";
  cycles(10, {0.0005, 0, 0});
  EXPECT_FALSE(wish_.deadman);
  ASSERT_EQ(driver_->lines().size(), 2u);
  EXPECT_NE(driver_->lines()[0].words.find("window"), std::string::npos) << driver_->lines()[0].words;
  window_answers_ = true;
  expect_to_have_to_press_anew();
}

TEST_F(HandAtTheSeat, WhoHoldsAKeyThatDoesNotCountIsToldWhy) {
  gl::WindowInput pressed;
  pressed.key_events.push_back({key_bindings()[static_cast<std::size_t>(HandKey::deadman)].code, true});
  driver_->take(pressed, view_.now);
  cycles(5);
  ASSERT_TRUE(wish_.deadman);
  EXPECT_EQ(said("keys").words, "");
  window_answers_ = false;
  cycles(19);  // of 0.02 s
  EXPECT_FALSE(wish_.deadman);
  window_answers_ = true;
  cycles(1);
  EXPECT_THAT(said("keys").words, testing::HasSubstr("a picture took 0.4 s"));
  EXPECT_EQ(said("keys").urgency, Urgency::trouble);
  cycles(250);
  EXPECT_THAT(said("keys").cure, testing::HasSubstr("let go, and press again")) << "the key is still held";
  EXPECT_TRUE(wish_.refused) << "what to do next is to let go";
  hold(true);
  cycles(5);
  EXPECT_TRUE(wish_.deadman) << "another device";
  EXPECT_FALSE(wish_.refused);
  hold(false);
  pressed.key_events.front().down = false;
  driver_->take(pressed, view_.now);
  EXPECT_EQ(said("keys").words, "");
  cycles(1);
  EXPECT_FALSE(wish_.refused);
}

TEST_F(HandAtTheSeat, AWindowThatHangsIsNoMatterToASeatThatNobodyDrives) {
  window_answers_ = false;
  cycles(50);
  EXPECT_EQ(said("hand").words, "");
  hold(true);
  cycles(5);
  EXPECT_FALSE(wish_.deadman);
  window_answers_ = true;
  expect_to_have_to_press_anew();
}

TEST_F(HandAtTheSeat, BeforeTheWindowsFirstLookNothingIsJudgedAndNoSwitchCounts) {
  open_driver();
  window_answers_ = false;
  cycles(30);
  hold(true);
  cycles(30);
  EXPECT_FALSE(wish_.deadman);
  driver_->take({}, view_.now);
  EXPECT_EQ(said("hand").words, "") << "a picture is drawn before the seat's next cycle";
  window_answers_ = true;
  expect_to_have_to_press_anew();
}

TEST_F(HandAtTheSeat, ADeviceThatGoesWhileItDrivesIsNamed) {
  hold(true);
  cycles(10, {0.0005, 0, 0});
  ASSERT_TRUE(wish_.deadman);
  EXPECT_EQ(said("device").words, "");
  hand_->state.connected = false;  // it says nothing of it itself, as a recording
  for (int i = 0; i < 100; ++i) {
    cycles(1);
    EXPECT_FALSE(wish_.deadman);
    EXPECT_EQ(said("hand").words, "") << "once is enough";
    EXPECT_EQ(said("device").words, "a hand has gone");
    EXPECT_NE(said("device").cure, "");
    EXPECT_EQ(said("device").urgency, Urgency::trouble);
  }
  hand_->state.connected = true;
  expect_to_have_to_press_anew();
  EXPECT_EQ(said("device").words, "");
}

TEST_F(HandAtTheSeat, ADeviceThatIsNotThereIsNamedUntilItComes) {
  open_driver();
  hand_->state = TrackerState{};
  hand_->state.trouble = "the gamepad is not there";
  hand_->state.cure = "plug it in";
  for (int i = 0; i < 5; ++i) {
    cycles(5);
    EXPECT_EQ(said("device").words, "the gamepad is not there");
    EXPECT_EQ(said("device").cure, "plug it in");
    EXPECT_EQ(said("device").urgency, Urgency::note);
  }
  hand_->state = TrackerState{};
  hand_->state.connected = hand_->state.tracked = true;
  cycles(2);
  EXPECT_EQ(said("device").words, "");
}

}  // namespace
}  // namespace foresight::hand_driver_test
