// Mock cameras in stepped time: nothing depends on how long anything takes.
#include "drivers/camera/stereo_camera.hpp"
#include "sim/live_view/mock_camera.hpp"
#include "sim/synth_run.hpp"
#include "tests/support/headless_test.hpp"

namespace foresight::sim::stepped_camera_test {
namespace {

using namespace std::chrono_literals;

class SteppedCamera : public HeadlessTest {
 protected:
  struct World {
    SteppedClock clock;
    std::shared_ptr<MockStereo> stereo;
    std::vector<RobotTime> asked;  // for the elbow

    World(const std::shared_ptr<const LiveLab>& lab, const MockCameraOptions& options) {
      const ShaftsAt shafts = [this](std::string_view joint, RobotTime t) {
        if (joint == "elbow") asked.push_back(t);
        return shafts_in_motion(joint, to_seconds(t - RobotTime{}));
      };
      stereo = std::make_shared<MockStereo>(lab, shafts, options, clock);
    }
  };

  void SetUp() override {
    HeadlessTest::SetUp();
    if (IsSkipped()) return;
    context_.reset();
    SynthOptions size;
    size.width = 80;
    size.height = 60;
    options_.lenses.left = synth_lens(size, false);
    options_.lenses.right = synth_lens(size, true);
    options_.light_coarser = 16;
    options_.rate = 20;
    lab_ = std::make_shared<const LiveLab>(LiveLab::Options{0.008, 1, {}});
  }

  /// Both eyes' bytes, one after the other, of some images.
  std::vector<std::uint8_t> film(int images) {
    World world(lab_, options_);
    MockCamera left("left", Side::left, world.stereo), right("right", Side::right, world.stereo);
    left.start();
    right.start();
    std::vector<std::uint8_t> out;
    for (int i = 0; i < images; ++i)
      for (MockCamera* camera : {&left, &right}) {
        CameraFrame frame;
        EXPECT_EQ(camera->wait_frame(camera == &left ? 1s : 0s, frame), CameraStatus::ok);
        out.insert(out.end(), frame.bytes.begin(), frame.bytes.end());
      }
    return out;
  }

  MockCameraOptions options_;
  std::shared_ptr<const LiveLab> lab_;
};

TEST_F(SteppedCamera, GivesTheSamePicturesOnEveryRun) {
  const auto first = film(5), second = film(5);
  ASSERT_EQ(first.size(), 5u * 2 * 80 * 60 * 2);
  EXPECT_TRUE(first == second);
  const std::size_t image = 80 * 60 * 2;
  EXPECT_FALSE(std::equal(first.begin(), first.begin() + image, first.begin() + 8 * image)) << "the head turns";
  EXPECT_FALSE(std::equal(first.begin(), first.begin() + image, first.begin() + image)) << "two eyes";
}

TEST_F(SteppedCamera, AsksTheShaftsForTheMiddleOfTheExposure) {
  World world(lab_, options_);
  MockCamera left("left", Side::left, world.stereo);
  left.start();
  CameraFrame frame;
  EXPECT_EQ(left.wait_frame(49ms, frame), CameraStatus::timeout);
  EXPECT_EQ(world.clock.now(), RobotTime{} + 49ms);
  ASSERT_EQ(left.wait_frame(10ms, frame), CameraStatus::ok);
  EXPECT_EQ(world.clock.now(), RobotTime{} + 50ms) << "no later than needed";
  EXPECT_EQ(frame.time, RobotTime{} + 50ms - 4ms) << "8 ms exposure";
  ASSERT_FALSE(world.asked.empty());
  for (const RobotTime t : world.asked) EXPECT_EQ(t, frame.time);
  left.set_exposure(20ms);
  ASSERT_EQ(left.wait_frame(1s, frame), CameraStatus::ok);
  EXPECT_EQ(frame.time, RobotTime{} + 100ms - 10ms);
}

TEST_F(SteppedCamera, GivesTheNewestToOneWhoComesLate) {
  World world(lab_, options_);
  MockCamera left("left", Side::left, world.stereo), right("right", Side::right, world.stereo);
  left.start();
  right.start();
  CameraFrame frame;
  world.clock.sleep_until(RobotTime{} + 330ms);
  ASSERT_EQ(left.wait_frame(0s, frame), CameraStatus::ok);
  EXPECT_EQ(frame.time, RobotTime{} + 300ms - 4ms);
  EXPECT_EQ(left.wait_frame(0s, frame), CameraStatus::timeout);
  ASSERT_EQ(right.wait_frame(0s, frame), CameraStatus::ok) << "the same instant";
  EXPECT_EQ(frame.time, RobotTime{} + 300ms - 4ms);
  ASSERT_EQ(left.wait_frame(1s, frame), CameraStatus::ok);
  EXPECT_EQ(frame.time, RobotTime{} + 350ms - 4ms);
}

}  // namespace
}  // namespace foresight::sim::stepped_camera_test
