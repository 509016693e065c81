// Runtimes that are not there, break, lie, and go away while the robot is driven.
#include <cmath>
#include <limits>

#include "display/head/head_display.hpp"
#include "tests/head_display/xr_test.hpp"
#include "tests/input/hand_world.hpp"

#include <openxr/openxr.h>

namespace foresight::head_faults_test {
namespace {

using namespace std::chrono_literals;
using openxr_runtime::looking;
using openxr_runtime::runtime;
using openxr_runtime::Seen;
using openxr_runtime::World;
using testing::HasSubstr;

class HeadFaults : public HeadDisplayTest {
 protected:
  bool focused() const { return display_->status().focused; }
  // Says why, keeps on trying, and shows once `heal` has healed it.
  void expect_trouble(const std::string& words, const std::function<void()>& heal) {
    run(150);
    const head::HeadStatus status = display_->status();
    EXPECT_FALSE(status.shown);
    EXPECT_THAT(status.trouble, HasSubstr(words));
    EXPECT_NE(status.cure, "");
    EXPECT_EQ(painter_.eyes, 0);
    heal();
    EXPECT_TRUE(until([this] { return focused(); }, 300)) << display_->status().trouble;
  }
  void use(const std::function<void(openxr_runtime::Settings&)>& change) {
    change(settings_);
    runtime().reset(settings_);
  }
};

TEST_F(HeadFaults, NoRuntime) {
  use_runtime("/nowhere/runtime.json");
  expect_trouble("no OpenXR runtime", [] { use_runtime(test_runtime()); });
  EXPECT_EQ(complaints(), "");
}

TEST_F(HeadFaults, ARuntimeWithoutOpenGL) {
  use([](auto& s) { s.opengl = false; });
  expect_trouble("does not know OpenGL", [this] { use([](auto& s) { s.opengl = true; }); });
  EXPECT_EQ(complaints(), "");
}

TEST_F(HeadFaults, AHeadsetThatIsNotPluggedIn) {
  use([](auto& s) { s.headset = false; });
  expect_trouble("headset is not there", [] { runtime().plug(true); });
  EXPECT_EQ(runtime().counts().instances, 1u) << "the runtime was kept";
  EXPECT_EQ(complaints(), "");
}

TEST_F(HeadFaults, ViewsOfNoSize) {
  use([](auto& s) { s.width = 0; });
  expect_trouble("without a pixel", [this] {
    display_.reset();
    use([](auto& s) { s.width = 64; });
    display_.emplace(head::HeadDisplayOptions{}, clock_, held_);
  });
}

TEST_F(HeadFaults, NoPicturesThatItCouldShow) {
  use([](auto& s) { s.srgb = "no"; });
  run(20);
  EXPECT_THAT(display_->status().trouble, HasSubstr("sRGB"));
}

TEST_F(HeadFaults, LargerViewsThanItCanLendAreMadeSmaller) {
  use([](auto& s) { s.width = 100'000, s.height = 20; });
  ASSERT_TRUE(until([this] { return focused(); }, 100)) << display_->status().trouble;
  EXPECT_EQ(complaints(), "");
}

TEST_F(HeadFaults, PosesThatAreNoNumbersAreNotDrawnNorFollowed) {
  Seen seen = Seen::tracked;
  use([&](auto& s) {
    s.world = [&](double) {
      World out;
      out.head_seen = seen;
      for (auto& hand : out.hands) hand.seen = seen, hand.squeeze = 1;
      return out;
    };
  });
  painter_.all_panels = {{true, true, true, 32, 16, 0.8, Pose::Identity()},
                         {true, true, false, 32, 16, 1, Pose::Identity()}};
  ASSERT_TRUE(until([this] { return focused(); }));
  run(2);
  ASSERT_TRUE(held_->hands[1].heard().tracked);
  for (const Seen bad : {Seen::no_number, Seen::lost}) {
    seen = bad;
    const auto before = runtime().counts();
    run(20);
    const auto after = runtime().counts();
    EXPECT_EQ(after.with_eyes, before.with_eyes);
    EXPECT_EQ(after.with_panels, before.with_panels + 20) << "words go with the head wherever it is";
    EXPECT_FALSE(painter_.frames.back().T_space_head);
    EXPECT_FALSE(held_->hands[1].heard().tracked);
    EXPECT_TRUE(held_->hands[1].heard().T_space_hand.matrix().allFinite());
  }
  EXPECT_EQ(display_->status().without_pose, 40u);
  seen = Seen::inferred;
  run(3);
  EXPECT_TRUE(painter_.frames.back().T_space_head) << "the head may be inferred, the robot follows no such hand";
  EXPECT_FALSE(held_->hands[1].heard().tracked);
  seen = Seen::tracked;
  run(3);
  EXPECT_TRUE(held_->hands[1].heard().tracked);
  EXPECT_EQ(complaints(), "");
}

TEST_F(HeadFaults, TimeThatJumpsMovesNoHand) {
  ASSERT_TRUE(until([this] { return focused(); }));
  run(2);
  for (const std::int64_t jump : std::array<std::int64_t, 3>{3'000'000'000, -2'000'000'000, 500'000'000'000'000}) {
    ASSERT_TRUE(held_->hands[1].heard().tracked);
    const auto jumps = display_->status().time_jumps;
    runtime().jump_time(jump);
    run(1);
    EXPECT_EQ(display_->status().time_jumps, jumps + 1);
    EXPECT_FALSE(held_->hands[1].heard().tracked);
    run(2);
  }
  EXPECT_TRUE(focused());
  EXPECT_EQ(complaints(), "");
}

TEST_F(HeadFaults, ADisplayThatStandsStillIsNoticed) {
  ASSERT_TRUE(until([this] { return focused(); }));
  run(2);
  const head::HeadStatus status = display_->status();
  const OperatorTime now{clock_.now().ns};
  EXPECT_FALSE(head::stands_still(status, now + 100ms));
  EXPECT_TRUE(head::stands_still(status, now + 600ms));
}

// The layer that looks on in all of these does see what is wrong.
TEST_F(HeadFaults, TheValidationLayerLooksOn) {
  if (!has_validation()) GTEST_SKIP() << "install openxr-layer-corevalidation";
  XrInstanceCreateInfo info{};
  info.type = XR_TYPE_INSTANCE_CREATE_INFO;
  info.applicationInfo = {"a test", 0, "", 0, XR_MAKE_VERSION(1, 0, 0)};
  const char* const extensions[] = {"XR_KHR_opengl_enable"};
  info.enabledExtensionCount = 1;
  info.enabledExtensionNames = extensions;
  XrInstance instance = XR_NULL_HANDLE;
  ASSERT_EQ(xrCreateInstance(&info, &instance), XR_SUCCESS);
  XrSystemGetInfo wrong{};  // without its type
  XrSystemId system = 0;
  EXPECT_TRUE(XR_FAILED(xrGetSystem(instance, &wrong, &system)));
  xrDestroyInstance(instance);
  EXPECT_THAT(complaints(), HasSubstr("xrGetSystem"));
}

/// The whole way from a controller to the drives of the lab's robot, the display's frames between them.
class HeadDrives : public HeadFaults {
 protected:
  class WorldClock final : public Clock {
   public:
    explicit WorldClock(const HandWorld& world) : world_(world) {}
    RobotTime now() const noexcept override { return {world_.now().ns}; }
    void sleep_until(RobotTime) noexcept override {}

   private:
    const HandWorld& world_;
  };
  void SetUp() override {
    HeadFaults::SetUp();
    if (IsSkipped()) return;
    use([this](auto& s) {
      s.tick = {};
      s.world = [this](double) {
        World out;
        out.hands[0].on = false;
        out.hands[1].squeeze = squeeze_;
        out.hands[1].pose.position = {0.2f, 1.0f + lift_, -0.3f};
        return out;
      };
    });
    world_.hand().settings().frame = HandFrame::base;
    display_.emplace(head::HeadDisplayOptions{}, world_clock_, held_);
  }
  // Cycles of the hand, every 8 ms; frames of the display go on unless it `stands`.
  void drive(int cycles, bool stands = false) {
    for (int i = 0; i < cycles; ++i) {
      if (!stands) display_->step(painter_);
      if (squeeze_ > 0) lift_ += 0.0004f;
      last_ = world_.cycle(hands_.read(world_.now()), true);
    }
  }
  void begin_driving() {
    drive(600);
    ASSERT_TRUE(focused()) << display_->status().trouble;
    squeeze_ = 1;
    drive(120);
    ASSERT_EQ(last_.phase, HandPhase::driving) << describe(last_, world_.joints()).name;
    ASSERT_GT(world_.following, 0);
  }
  // All that may not happen has not happened, and nothing moves.
  void expect_rest() {
    EXPECT_FALSE(last_.deadman);
    drive(250);  // 2 s: it has come to rest
    std::vector<double> shafts;
    for (std::size_t i = 0; i < world_.joints().size(); ++i) shafts.push_back(world_.shaft(i));
    drive(100);
    for (std::size_t i = 0; i < shafts.size(); ++i) EXPECT_EQ(world_.shaft(i), shafts[i]) << i;
    EXPECT_EQ(world_.moved_while_open, 0);
    EXPECT_EQ(world_.jumps_at_press, 0);
    EXPECT_EQ(world_.steps_too_long, 0);
    EXPECT_EQ(world_.shafts_moved_at_rest, 0);
  }
  // It does not go on by itself, but with the next press.
  void expect_press_anew() {
    ASSERT_TRUE([&] {
      for (int i = 0; i < 600 && !focused(); ++i) drive(1);
      return focused();
    }()) << display_->status().trouble;
    drive(60);
    EXPECT_FALSE(last_.deadman) << "the switch has been held all the time";
    squeeze_ = 0;
    drive(60);
    squeeze_ = 1;
    drive(60);
    EXPECT_TRUE(last_.deadman) << describe(last_, world_.joints()).name;
    EXPECT_EQ(world_.jumps_at_press, 0);
  }

  HandWorld world_;
  WorldClock world_clock_{world_};
  head::HeadHands hands_{held_};
  float squeeze_ = 0, lift_ = 0;
  HandCycle last_;
};

TEST_F(HeadDrives, AHeadsetThatIsTakenOffLeavesTheRobotAtRest) {
  begin_driving();
  runtime().take_off();
  drive(8);
  expect_rest();
  runtime().put_on();
  expect_press_anew();
}

TEST_F(HeadDrives, ALostSessionLeavesTheRobotAtRest) {
  begin_driving();
  runtime().lose_session();
  drive(2);
  EXPECT_FALSE(last_.deadman);
  EXPECT_EQ(display_->status().losses, 1);
  expect_press_anew();
  squeeze_ = 0;
  drive(10);
  expect_rest();
}

TEST_F(HeadDrives, ADeadRuntimeLeavesTheRobotAtRest) {
  begin_driving();
  runtime().lose_instance();
  drive(2);
  EXPECT_FALSE(last_.deadman);
  expect_press_anew();
  squeeze_ = 0;
  drive(10);
  expect_rest();
}

TEST_F(HeadDrives, AnUnpluggedHeadsetLeavesTheRobotAtRest) {
  begin_driving();
  runtime().plug(false);
  drive(2);
  EXPECT_FALSE(last_.deadman);
  expect_rest();
  runtime().plug(true);
  expect_press_anew();
}

TEST_F(HeadDrives, AMenuLeavesTheRobotAtRest) {
  begin_driving();
  runtime().open_menu();
  drive(4);
  expect_rest();
  runtime().put_on();
  expect_press_anew();
}

TEST_F(HeadDrives, FramesThatStopLeaveTheRobotAtRest) {
  begin_driving();
  drive(27, true);  // 216 ms
  EXPECT_FALSE(last_.deadman);
  drive(250, true);
  EXPECT_EQ(world_.moved_while_open, 0);
  expect_press_anew();
}

TEST_F(HeadDrives, ARecentredSpaceIsNotFollowed) {
  begin_driving();
  runtime().recentre(looking({0, 0.04f, 0}, 0));  // less than what counts as a jump
  drive(8);
  EXPECT_FALSE(last_.deadman);
  expect_rest();
}

}  // namespace
}  // namespace foresight::head_faults_test
