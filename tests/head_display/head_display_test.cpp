// A head display through its life: shown, looked at, taken off, put on, recentred, closed.
#include "display/head/head_display.hpp"

#include <cmath>

#include "display/head/runtime_offer.hpp"
#include "gl/read_texture.hpp"
#include "tests/head_display/xr_test.hpp"

namespace foresight::head_display_test {
namespace {

using namespace std::chrono_literals;
using openxr_runtime::looking;
using openxr_runtime::runtime;
using openxr_runtime::World;

World nodding(double t) {
  World out;
  out.head = looking({0.05f * static_cast<float>(std::sin(t)), 1.2f, 0}, 0.4 * std::sin(0.9 * t), 0.2 * std::sin(t));
  for (auto& hand : out.hands) {
    hand.pose.position = {0.2f, 1.0f + 0.1f * static_cast<float>(std::sin(2 * t)), -0.3f};
    hand.trigger = 0.25f;
  }
  return out;
}

class HeadDisplayLife : public HeadDisplayTest {
 protected:
  bool focused() const { return display_->status().focused; }
};

TEST_F(HeadDisplayLife, ShowsEachEyeItsOwnPicture) {
  cv::Mat left, right;
  runtime().reset([this, &left, &right] {
    auto settings = settings_;
    settings.shown = [&](const openxr_runtime::ShownFrame& frame) {
      if (!frame.eyes[0] || !frame.eyes[1] || !left.empty()) return;
      left = gl::read_texture(frame.eyes[0]);  // rows from the bottom
      right = gl::read_texture(frame.eyes[1]);
    };
    return settings;
  }());
  ASSERT_TRUE(until([this] { return focused(); })) << display_->status().trouble;
  EXPECT_EQ(display_->status().headset, "simulated headset");
  EXPECT_EQ(display_->status().runtime, "test runtime 0.1.0");
  EXPECT_NEAR(display_->status().rate_hz, 90, 0.1);
  ASSERT_FALSE(left.empty());
  EXPECT_EQ(left.at<cv::Vec4b>(60, 32), cv::Vec4b(255, 0, 0, 255)) << "bytes as they were drawn, the top above";
  EXPECT_EQ(right.at<cv::Vec4b>(60, 32), cv::Vec4b(0, 255, 0, 255));
  EXPECT_EQ(left.at<cv::Vec4b>(3, 32)[0], 51);
  EXPECT_EQ(complaints(), "");
}

// Where the head and the eyes are is asked of the runtime after it has paced the frame, for when the frame is seen.
TEST_F(HeadDisplayLife, LooksFromWhereTheHeadWillBe) {
  std::vector<World> worlds;
  settings_.world = nodding;
  settings_.shown = [&](const openxr_runtime::ShownFrame& frame) {
    if (frame.eyes[0]) worlds.push_back(frame.world);
  };
  runtime().reset(settings_);
  ASSERT_TRUE(until([this] { return focused(); }));
  run(200);
  ASSERT_EQ(painter_.frames.size(), worlds.size());
  for (std::size_t i = 0; i < worlds.size(); ++i) {
    const auto& p = worlds[i].head.position;
    const auto& q = worlds[i].head.orientation;
    const auto expected = head::checked_pose(Eigen::Vector3f(p[0], p[1], p[2]).cast<double>(),
                                             Eigen::Quaternionf(q[3], q[0], q[1], q[2]).cast<double>());
    const head::HeadFrame& frame = painter_.frames[i];
    ASSERT_TRUE(frame.T_space_head);
    ASSERT_TRUE(frame.T_space_head->isApprox(*expected, 1e-6)) << i;
    const Eigen::Vector3d apart = frame.T_space_head->linear().transpose() *
                                  (frame.eyes[0].T_space_eye.translation() - frame.eyes[1].T_space_eye.translation());
    ASSERT_TRUE(apart.isApprox(Eigen::Vector3d(0, 0.063, 0), 1e-4)) << "the left eye is left: " << apart.transpose();
  }
  EXPECT_EQ(runtime().counts().poses_off_time, 0u);
  EXPECT_EQ(complaints(), "");
}

TEST_F(HeadDisplayLife, ControllersAreHands) {
  settings_.world = [](double t) {
    World out = nodding(t);
    out.hands[0].on = false;
    out.hands[1].squeeze = t > 3 ? 1.0f : 0.0f;
    out.hands[1].stick_x = 1;
    out.hands[1].first_button = t > 4;
    return out;
  };
  runtime().reset(settings_);
  head::HeadHands hands(held_);
  const auto now = [this] { return OperatorTime{clock_.now().ns}; };
  EXPECT_FALSE(hands.read(now()).connected) << "nothing is shown yet";
  ASSERT_TRUE(until([this] { return focused(); }));
  run(1);
  const TrackerState open = hands.read(now());
  ASSERT_TRUE(open.connected && open.tracked) << open.trouble;
  EXPECT_FALSE(open.buttons.held(TrackerButton::deadman));
  EXPECT_EQ(open.time, now()) << "of our clock";
  EXPECT_NEAR(*open.grip, 0.25, 1e-6);
  EXPECT_NEAR(open.pan_rate, -1, 1e-6) << "to the right";
  EXPECT_NEAR(open.T_space_hand.translation().x(), 0.3, 1e-6) << "ahead";
  EXPECT_NEAR(open.T_space_hand.translation().y(), -0.2, 1e-6) << "on the right";
  ASSERT_TRUE(open.T_space_head);
  ASSERT_TRUE(until([&] { return hands.read(now()).buttons.held(TrackerButton::deadman); }));
  EXPECT_TRUE(hands.read(now()).buttons.held(TrackerButton::clutch));
  EXPECT_FALSE(hands.read(now()).buttons.held(TrackerButton::home_view));
  ASSERT_TRUE(until([&] { return hands.read(now()).buttons.held(TrackerButton::home_view); }));
  EXPECT_FALSE(held_->hands[0].heard().connected) << "it is off";
  EXPECT_EQ(complaints(), "");
}

TEST_F(HeadDisplayLife, EveryKnownControllerDrives) {
  for (const char* profile : {"khr/simple_controller", "oculus/touch_controller", "valve/index_controller",
                              "htc/vive_controller", "microsoft/motion_controller"}) {
    settings_.profile = std::string("/interaction_profiles/") + profile;
    settings_.world = [](double t) {
      World out = nodding(t);
      for (auto& hand : out.hands) hand.squeeze = 1;
      return out;
    };
    display_.reset();
    runtime().reset(settings_);
    display_.emplace(head::HeadDisplayOptions{}, clock_, held_);
    ASSERT_TRUE(until([this] { return held_->hands[0].heard().buttons.held(TrackerButton::deadman); })) << profile;
    EXPECT_TRUE(held_->hands[1].heard().tracked) << profile;
    EXPECT_EQ(complaints(), "") << profile;
  }
}

TEST_F(HeadDisplayLife, AMenuTakesTheControllersAndNotThePicture) {
  settings_.world = nodding;
  runtime().reset(settings_);
  ASSERT_TRUE(until([this] { return focused(); }));
  run(2);
  ASSERT_TRUE(held_->hands[1].heard().connected);
  runtime().open_menu();
  ASSERT_TRUE(until([this] { return !focused(); }, 10));
  const auto drawn = runtime().counts().with_eyes;
  run(5);
  EXPECT_TRUE(display_->status().shown);
  EXPECT_EQ(runtime().counts().with_eyes, drawn + 5);
  EXPECT_FALSE(held_->hands[1].heard().connected);
  EXPECT_STRNE(held_->hands[1].heard().trouble, "");
  runtime().put_on();
  ASSERT_TRUE(until([this] { return focused(); }, 10));
  run(2);
  EXPECT_TRUE(held_->hands[1].heard().connected);
  EXPECT_EQ(complaints(), "");
}

TEST_F(HeadDisplayLife, ATakenOffHeadsetShowsNothingAndComesBack) {
  settings_.world = nodding;
  runtime().reset(settings_);
  ASSERT_TRUE(until([this] { return focused(); }));
  runtime().take_off();
  ASSERT_TRUE(until([this] { return !display_->status().shown; }, 10));
  const int eyes = painter_.eyes;
  run(20);
  EXPECT_EQ(painter_.eyes, eyes) << "nobody looks";
  EXPECT_FALSE(held_->hands[1].heard().connected);
  EXPECT_NE(display_->status().trouble, "");
  runtime().put_on();
  ASSERT_TRUE(until([this] { return focused(); }, 10));
  EXPECT_EQ(complaints(), "");
}

TEST_F(HeadDisplayLife, ARecentredSpaceIsToldAndMovesNoHand) {
  settings_.world = [](double t) {
    World out = nodding(t);
    out.hands[1].squeeze = 1;
    return out;
  };
  runtime().reset(settings_);
  ASSERT_TRUE(until([this] { return focused(); }));
  run(3);
  ASSERT_TRUE(held_->hands[1].heard().tracked);
  runtime().recentre(looking({0.01f, 0, 0.02f}, 0.05));
  int moved = 0, untracked = 0;
  for (int i = 0; i < 10; ++i) {
    run(1);
    const bool is_moved = painter_.frames.back().space_moved, is_untracked = !held_->hands[1].heard().tracked;
    EXPECT_EQ(is_moved, is_untracked) << "a step of the space is none of the hand";
    moved += is_moved;
    untracked += is_untracked;
  }
  EXPECT_EQ(moved, 1);
  EXPECT_EQ(untracked, 1);
  EXPECT_EQ(complaints(), "");
}

TEST_F(HeadDisplayLife, PanelsStandInTheRoomOrGoWithTheHead) {
  painter_.all_panels.resize(3);
  painter_.all_panels[0] = {true, false, true, 40, 20, 0.8, Pose::Identity()};
  painter_.all_panels[0].T_frame_panel.translation() = Eigen::Vector3d(1.5, 0, -0.4);
  painter_.all_panels[1] = {true, true, false, 32, 24, 1, Pose::Identity()};
  std::size_t panels = 0;
  cv::Mat words;
  settings_.world = nodding;
  settings_.shown = [&](const openxr_runtime::ShownFrame& frame) {
    panels = frame.panels.size();
    if (panels == 2 && words.empty()) words = gl::read_texture(frame.panels[0]);
  };
  runtime().reset(settings_);
  ASSERT_TRUE(until([this] { return focused(); }));
  const int before = painter_.drawn_panels;
  run(10);
  EXPECT_EQ(panels, 2u);
  EXPECT_EQ(painter_.drawn_panels, before + 10) << "only the one that changes is drawn again";
  ASSERT_FALSE(words.empty());
  EXPECT_EQ(words.at<cv::Vec4b>(10, 20), cv::Vec4b(0, 0, 255, 255));
  painter_.all_panels[0].shown = false;
  painter_.all_panels[1].width_px = 48;  // of another camera
  run(2);
  EXPECT_EQ(panels, 1u);
  EXPECT_EQ(complaints(), "");
}

TEST_F(HeadDisplayLife, ClosedInTheMenuItStaysClosed) {
  ASSERT_TRUE(until([this] { return focused(); }));
  runtime().close_in_menu();
  ASSERT_TRUE(until([this] { return display_->status().ended; }, 50));
  EXPECT_NE(display_->status().cure, "");
  run(300);
  EXPECT_EQ(runtime().counts().sessions, 1u);
  EXPECT_EQ(complaints(), "");
}

TEST_F(HeadDisplayLife, LeavesInTheRuntimesOrder) {
  ASSERT_TRUE(until([this] { return focused(); }));
  display_->finish();
  EXPECT_TRUE(display_->status().ended);
  EXPECT_EQ(runtime().state(), "UNKNOWN") << "the session is gone";
  run(3);
  EXPECT_EQ(runtime().counts().sessions, 1u);
  EXPECT_EQ(complaints(), "");
}

TEST_F(HeadDisplayLife, SaysWhatTheRuntimeOffersBeforeAWindowIsOpened) {
  ASSERT_TRUE(until([this] { return focused(); }));
  display_->finish();  // the loader lets go of a runtime with its last instance
  use_runtime("/nowhere/runtime.json");
  EXPECT_FALSE(head::ask_runtime().there);
  use_runtime(test_runtime());
  EXPECT_TRUE(head::ask_runtime().there);
  EXPECT_TRUE(head::ask_runtime().opengl);
  EXPECT_TRUE(head::ask_runtime().egl);
  settings_.egl = false;
  runtime().reset(settings_);
  EXPECT_FALSE(head::ask_runtime().egl);
}

// Ten minutes at 90 Hz of simulated time: taken off, a menu, recentred, lost and found again.
TEST_F(HeadDisplayLife, ALongSessionKeepsEveryRule) {
  painter_.all_panels = {{true, true, true, 32, 16, 0.8, Pose::Identity()}};
  settings_.world = nodding;
  settings_.width = settings_.height = 16;
  runtime().reset(settings_);
  constexpr int kMinutes = 10;
  constexpr int kRoundsAMinute = 5400;  // a few of them without a frame
  for (int round = 0; round < kMinutes * kRoundsAMinute; ++round) {
    painter_.frames.clear();
    run(1);
    switch (round % kRoundsAMinute) {
      case 400: runtime().take_off(); break;
      case 800: runtime().put_on(); break;
      case 1200: runtime().open_menu(); break;
      case 1300: runtime().put_on(); break;
      case 2000: runtime().recentre(looking({0.1f, 0, 0}, 0.3)); break;
      case 2500: runtime().lose_session(); break;
      case 3300: runtime().plug(false); break;
      case 3400: runtime().plug(true); break;
      case 4000: runtime().lose_instance(); break;
      default: break;
    }
  }
  const auto counts = runtime().counts();
  const head::HeadStatus status = display_->status();
  EXPECT_TRUE(status.focused) << status.trouble;
  EXPECT_GT(status.frames, 4000u * static_cast<std::uint64_t>(kMinutes));
  EXPECT_EQ(status.losses, 3 * kMinutes);
  EXPECT_EQ(counts.sessions, 1u + 3u * static_cast<std::uint64_t>(kMinutes));
  EXPECT_EQ(counts.ended, counts.begun);
  EXPECT_EQ(counts.ended, status.frames);
  EXPECT_GT(counts.poses, 4u * 3500u * static_cast<std::uint64_t>(kMinutes)) << "head, eyes and two hands";
  EXPECT_EQ(counts.poses_off_time, 0u);
  EXPECT_EQ(status.without_pose, 0u);
  EXPECT_EQ(complaints(), "");
  if (!has_validation()) GTEST_SKIP() << "without the validation layer: install openxr-layer-corevalidation";
}

}  // namespace
}  // namespace foresight::head_display_test
