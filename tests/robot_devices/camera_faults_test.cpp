// Cameras that fail while the arm and the head move: the robot goes on within its limits, and the view says what is
// wrong. The cameras' own driver runs, above a kernel that is made up.
#include <gmock/gmock.h>

#include "common/error.hpp"
#include "drivers/camera/v4l2_camera.hpp"
#include "session/camera_watch.hpp"
#include "tests/camera/fake_v4l2.hpp"
#include "tests/robot_devices/live_robot.hpp"

namespace foresight::camera_faults_test {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;

class CameraFaults : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    live_.get_moving();
    live_.clock().every(10ms, [this](RobotTime) { watch_.step(); });
    live_.move(2s);
    ASSERT_EQ(watch_.line().fault, "");
    pairs_ = watch_.line().status.pairing.pairs;
  }

  std::unique_ptr<StereoCamera> open() {
    if (!refusal_.empty()) throw RuntimeFailure(refusal_, "wait");
    const auto camera = [&](const char* name, FakeV4l2& kernel) {
      V4l2Camera::Options options;
      options.device = "serial:C0FFEE";
      options.settings.width = 64;
      options.settings.height = 48;
      options.settings.readout = 20ms;
      return std::make_unique<V4l2Camera>(name, options, live_.clock(), kernel);
    };
    return std::make_unique<StereoCamera>(camera("left", left_), camera("right", right_), live_.clock());
  }
  std::string text() const { return camera_text(watch_.line()); }
  std::uint64_t new_pairs() {
    const std::uint64_t before = std::exchange(pairs_, watch_.line().status.pairing.pairs);
    return pairs_ - before;
  }
  /// The robot has noticed nothing.
  void expect_following(const char* when) {
    EXPECT_EQ(live_.robot().status().gate.state, GateState::following) << when;
    EXPECT_EQ(live_.robot().status().gate.reason, GateReason::none) << when;
    EXPECT_GT(live_.fastest(), 0.01) << when;
    live_.expect_limits_kept(when, true);
  }
  void expect_all_well(const char* when) {
    new_pairs();
    live_.move(1s);
    EXPECT_GE(new_pairs(), 29u) << when << text();
    EXPECT_EQ(watch_.line().fault, "") << when;
    EXPECT_NEAR(watch_.line().pairs_per_s, 30, 1) << when;
    EXPECT_LT(watch_.line().age.value(), 60ms) << when;
    expect_following(when);
  }

  LiveRobot live_{GetParam()};
  FakeV4l2 left_{live_.clock()}, right_{live_.clock()};
  std::string refusal_;
  std::uint64_t pairs_ = 0;
  CameraWatch watch_{[this] { return open(); }, live_.clock()};
};

TEST_P(CameraFaults, NoneShowsThirtyPairsASecond) {
  expect_all_well("without a fault");
  EXPECT_THAT(text(), AllOf(HasSubstr("30 pairs/s"), HasSubstr("lost 0, 0 times")));
}

TEST_P(CameraFaults, UnpluggedAndBack) {
  left_.present = false;
  live_.move(3s);
  EXPECT_LE(new_pairs(), 1u);
  EXPECT_THAT(text(), AllOf(HasSubstr("the left camera is lost"), HasSubstr("0 pairs/s")));
  EXPECT_GT(watch_.line().age.value(), 2900ms);
  EXPECT_GT(watch_.line().status.pairing.unpaired[1], 60u) << "the right one goes on";
  expect_following("unplugged");
  left_.present = true;
  live_.move(2s);
  expect_all_well("plugged in again");
  EXPECT_THAT(text(), AllOf(HasSubstr("before: the left camera is lost"), HasSubstr("lost 1, 0 times")));
}

TEST_P(CameraFaults, BothUnplugged) {
  left_.present = right_.present = false;
  live_.move(2s);
  EXPECT_THAT(text(), HasSubstr("both cameras are lost"));
  expect_following("unplugged");
  left_.present = right_.present = true;
  live_.move(2s);
  expect_all_well("plugged in again");
}

TEST_P(CameraFaults, OneOfThePairFrozen) {
  right_.hangs = true;
  live_.move(800ms);
  EXPECT_THAT(text(), HasSubstr("the right camera is frozen"));
  EXPECT_LE(new_pairs(), 1u);
  expect_following("frozen");
  live_.move(1s);  // its driver's watchdog starts the stream again
  expect_all_well("going again");
  EXPECT_THAT(text(), HasSubstr("before: the right camera is frozen"));
}

TEST_P(CameraFaults, OneOfThePairFrozenForGood) {
  right_.hangs_for_good = true;
  live_.move(6s);
  EXPECT_GE(watch_.line().losses[1], 1u) << "given up by its driver";
  EXPECT_THAT(text(), HasSubstr("the right camera is "));
  expect_following("frozen");
  right_.hangs_for_good = false;
  live_.move(2s);
  expect_all_well("going again");
  EXPECT_THAT(text(), HasSubstr("before: the right camera is frozen")) << "with which it began";
}

TEST_P(CameraFaults, TimesThatJump) {
  for (const Duration jump : {Duration(10s), Duration(-10s), Duration(1h)}) {
    const std::uint64_t before = watch_.line().status.pairing.jumps[0];
    left_.jump = jump;
    live_.move(1s);
    EXPECT_LE(new_pairs(), 1u) << "no pair with a time that nobody believes";
    EXPECT_THAT(text(), HasSubstr("the left camera's capture times jump"));
    expect_following("jumping");
    left_.jump = Duration{0};
    live_.move(1s);
    expect_all_well("steady again");
    EXPECT_GT(watch_.line().status.pairing.jumps[0], before + 25);
    EXPECT_THAT(text(), HasSubstr("before: the left camera's capture times jump"));
  }
}

TEST_P(CameraFaults, TimesThatDriftApart) {
  left_.jump = -15ms;  // more than the tolerance of 8 ms, less than to the next image
  live_.move(2s);
  EXPECT_THAT(text(), HasSubstr("differ by more than the tolerance"));
  expect_following("apart");
}

INSTANTIATE_TEST_SUITE_P(Rigs, CameraFaults, testing::Values("minerva.yaml", "cia402.yaml"),
                         [](const auto& i) { return std::string(i.param).substr(0, std::string(i.param).find('.')); });

TEST(CameraWatch, TriesAgainWhereCamerasDoNotStart) {
  SteppedClock clock;
  FakeV4l2 left(clock), right(clock);
  int tries = 0;
  CameraWatch watch(
      [&]() -> std::unique_ptr<StereoCamera> {
        if (++tries < 3) throw RuntimeFailure("the left camera is elsewhere", "fetch it");
        V4l2Camera::Options options;
        options.device = "/dev/video2";
        options.settings.width = 64;
        options.settings.height = 48;
        return std::make_unique<StereoCamera>(std::make_unique<V4l2Camera>("left", options, clock, left),
                                              std::make_unique<V4l2Camera>("right", options, clock, right), clock);
      },
      clock);
  clock.every(10ms, [&](RobotTime) { watch.step(); });
  clock.sleep_until(clock.now() + 4s);
  EXPECT_EQ(tries, 1);
  EXPECT_THAT(camera_text(watch.line()), AllOf(HasSubstr("not started"), HasSubstr("elsewhere"), HasSubstr("fetch")));
  clock.sleep_until(clock.now() + 10s);
  EXPECT_EQ(tries, 3);
  EXPECT_EQ(watch.line().fault, "");
  EXPECT_GT(watch.line().status.pairing.pairs, 20u);
}

}  // namespace
}  // namespace foresight::camera_faults_test
