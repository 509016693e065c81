// Recordings of devices, ours and others'.
#include "input/tracker_trace.hpp"

#include <gmock/gmock.h>

#include "common/error.hpp"
#include "input/recorded_tracker.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/folders.hpp"

namespace foresight::tracker_trace_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class TrackerTraceTest : public testing::Test {
 protected:
  TrackerTrace read(const std::string& text, const TrackerTraceOptions& options = {}) {
    return read_tracker_trace(folder_.write("trace.csv", text), options);
  }
  std::string refusal(const std::string& text) {
    try {
      read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  static std::filesystem::path recorded(const std::string& name) { return data_folder() / name; }
  TempFolder folder_;
};

constexpr const char* kTip = "time_s,x,y,z,qx,qy,qz,qw,gripper\n";

TEST_F(TrackerTraceTest, OlderRecordingsLackAButton) {
  TrackerState said;
  said.connected = true;
  said.buttons.set(TrackerButton::clutch);
  said.buttons.set(TrackerButton::to_start);
  std::string heading = trace_heading();
  const std::string column = "to_start";
  ASSERT_NE(heading.find(column), heading.npos);
  heading.replace(heading.find(column), column.size(), "something_else");
  const TrackerTrace trace = read(heading + trace_row(0ns, said));
  ASSERT_EQ(trace.rows.size(), 1u);
  EXPECT_TRUE(trace.rows[0].state.buttons.held(TrackerButton::clutch));
  EXPECT_FALSE(trace.rows[0].state.buttons.held(TrackerButton::to_start));
}

TEST_F(TrackerTraceTest, WhatWeWriteIsReadAsItWas) {
  TrackerState said;
  said.connected = said.tracked = true;
  said.T_space_hand = Eigen::Translation3d(0.1, -2, 1e-3) * Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 2) / 3);
  said.T_space_head = Pose(Eigen::Translation3d(0, 0, 1.6));
  said.buttons.set(TrackerButton::clutch);
  said.buttons.set(TrackerButton::next_joint);
  said.grip = 0.25;
  said.joint = 3;
  said.pan_rate = -0.5;
  const TrackerTrace trace = read(trace_heading() + trace_row(0ns, {}) + trace_row(12'345'678ns, said));
  ASSERT_EQ(trace.rows.size(), 2u);
  EXPECT_FALSE(trace.rows[0].state.connected);
  EXPECT_FALSE(trace.rows[0].state.grip);
  const TrackerState& now = trace.rows[1].state;
  EXPECT_EQ(trace.rows[1].time, 12'345'678ns);
  EXPECT_TRUE(now.T_space_hand.isApprox(said.T_space_hand, 1e-14));
  ASSERT_TRUE(now.T_space_head);
  EXPECT_TRUE(now.T_space_head->isApprox(*said.T_space_head, 1e-14));
  EXPECT_EQ(now.buttons, said.buttons);
  EXPECT_EQ(now.grip, said.grip);
  EXPECT_EQ(now.joint, said.joint);
  EXPECT_EQ(now.pan_rate, said.pan_rate);
}

TEST_F(TrackerTraceTest, WhereAPedalWasUpTheSwitchIsOpen) {
  const TrackerTrace trace =
      read(std::string(kTip) + "0,0,0,0,0,0,0,1,100\n0.01,0,0,0,0,0,0,1,65\n1.01,0,0,0,0,0,0,1,30\n");
  EXPECT_FALSE(trace.rows.front().state.buttons.held(TrackerButton::deadman)) << "seen open first";
  EXPECT_EQ(trace.rows.back().state.grip, 1.0);
  EXPECT_TRUE(trace.rows.back().state.buttons.held(TrackerButton::deadman));
  int open = 0;
  for (std::size_t i = 1; i < trace.rows.size(); ++i) {
    open += !trace.rows[i].state.buttons.held(TrackerButton::deadman);
    EXPECT_LE(trace.rows[i].time - trace.rows[i - 1].time, 100ms) << "the device goes on saying so";
  }
  EXPECT_GE(open, 15);
}

TEST_F(TrackerTraceTest, WhatIsNoneIsRefusedByItsPlace) {
  EXPECT_THAT(refusal("a,b,c\n1,2,3\n"), HasSubstr("trace.csv:1"));
  EXPECT_THAT(refusal("a,b,c\n1,2,3\n"), HasSubstr("gripper"));
  EXPECT_THAT(refusal(kTip), HasSubstr("no rows"));
  EXPECT_THAT(refusal(""), HasSubstr("no rows"));
  const std::string good = std::string(kTip) + "1,0,0,0,0,0,0,1,100\n";
  EXPECT_THAT(refusal(good + "0.5,0,0,0,0,0,0,1,100\n"), HasSubstr("goes back"));
  EXPECT_THAT(refusal(good + "2,nan,0,0,0,0,0,1,100\n"), HasSubstr("trace.csv:3:3"));
  EXPECT_THAT(refusal(good + "2,0,0,0,0,0,0,2,100\n"), HasSubstr("quaternion"));
  EXPECT_THAT(refusal(good + "2,0,0,0\n"), HasSubstr("4 fields"));
  EXPECT_THAT(refusal(good + "x,0,0,0,0,0,0,1,100\n"), HasSubstr("seconds"));
  EXPECT_THAT(refusal(good + "2,1e300,0,0,0,0,0,1,100\n"), HasSubstr("metres"));
}

TEST_F(TrackerTraceTest, ARecordingPlaysInItsTimeAndEnds) {
  RecordedTracker device(read(std::string(kTip) + "5,0,0,0,0,0,0,1,100\n5.05,1,0,0,0,0,0,1,100\n"));
  const OperatorTime begin{77'000'000'000};
  EXPECT_EQ(device.read(begin).time, begin);
  const TrackerState middle = device.read(begin + 149ms);
  EXPECT_EQ(middle.T_space_hand.translation().x(), 0);
  EXPECT_EQ(device.read(begin + 150ms).T_space_hand.translation().x(), 1);
  EXPECT_EQ(device.read(begin + 150ms).time, begin + 150ms);
  const TrackerState after = device.read(begin + 10s);
  EXPECT_FALSE(after.connected);
  EXPECT_THAT(after.trouble, HasSubstr("ended"));
  EXPECT_TRUE(device.ended());
}

TEST_F(TrackerTraceTest, RecordedControllersAreReadInOurFrames) {
  const auto file = recorded("quest_controllers/controllers.csv");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recorded data: " << file;
  const TrackerTrace left = read_tracker_trace(file, {.side = TrackerSide::left});
  EXPECT_EQ(left.rows.size(), 1197u);
  int tracked = 0, held = 0;
  for (const TrackerTrace::Row& row : left.rows) {
    tracked += row.state.tracked;
    held += row.state.buttons.held(TrackerButton::deadman);
    ASSERT_TRUE(row.state.T_space_head);
    EXPECT_NEAR(row.state.T_space_head->translation().z(), 1.25, 0.1) << "up is z";
    if (row.state.tracked) {
      EXPECT_GT(row.state.T_space_hand.translation().x(), 0) << "hands are before the head";
      EXPECT_LT(row.state.T_space_head->linear()(2, 0), 0.8) << "it looks forward";
      EXPECT_GT(row.state.T_space_head->linear()(0, 0), 0.5) << "which is x";
    }
  }
  EXPECT_GT(tracked, 900);
  EXPECT_GT(held, 10) << "the left squeeze is used in it";
  const Eigen::Vector3d first = read_tracker_trace(file).rows.front().state.T_space_hand.translation();
  EXPECT_LT(first.y(), left.rows.front().state.T_space_hand.translation().y()) << "the right hand is to the right";
}

TEST_F(TrackerTraceTest, NumbersBeyondTheGrippersEndsAreCounted) {
  const std::string pose = ",0,0,0,0,0,0,1,";
  const TrackerTrace trace =
      read(kTip + ("0" + pose + "100\n0.1" + pose + "30\n0.2" + pose + "0.08\n0.3" + pose + "120\n"));
  EXPECT_EQ(trace.beyond.column, "gripper");
  EXPECT_EQ(trace.beyond.rows, 2u);
  EXPECT_EQ(trace.beyond.of, 4u);
  EXPECT_EQ(trace.beyond.least, 0.08);
  EXPECT_EQ(trace.beyond.most, 120);
  EXPECT_EQ(trace.rows.back().state.grip, 0) << "the nearer end";
  EXPECT_EQ(read(kTip + ("0" + pose + "50\n")).beyond.rows, 0u);
}

TEST_F(TrackerTraceTest, RecordedHandsCarryNoSwitchUnlessItIsHeldForThem) {
  const auto file = recorded("quest_controllers/hands.csv");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recorded data: " << file;
  const auto held = [&](bool hold) {
    int count = 0;
    for (const TrackerTrace::Row& row : read_tracker_trace(file, {.hold_switch = hold}).rows)
      count += row.state.buttons.held(TrackerButton::deadman);
    return count;
  };
  EXPECT_EQ(held(false), 0);
  EXPECT_GT(held(true), 100);
}

TEST_F(TrackerTraceTest, RecordedToolsAreReadWithTheirPedal) {
  const auto file = recorded("desk_teleop/S7_T1_right.csv");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recorded data: " << file;
  int presses = 0;
  bool before = true;
  for (const TrackerTrace::Row& row : read_tracker_trace(file).rows) {
    const bool held = row.state.buttons.held(TrackerButton::deadman);
    presses += held && !before;
    before = held;
  }
  EXPECT_EQ(presses, 4) << "the begin, and after each of three gaps";
}

}  // namespace
}  // namespace foresight::tracker_trace_test
