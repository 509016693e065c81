// In real time, on whatever renders: slow machines skip instants, but what they see is true.
#include "sim/live_view/mock_camera.hpp"

#include <opencv2/imgproc.hpp>

#include "drivers/camera/stereo_camera.hpp"
#include "sim/picture.hpp"
#include "sim/synth_run.hpp"
#include "tests/support/headless_test.hpp"

namespace foresight::sim {
namespace {

using namespace std::chrono_literals;

class MockCameraTest : public HeadlessTest {
 protected:
  void SetUp() override {
    HeadlessTest::SetUp();
    if (IsSkipped()) return;
    context_.reset();  // only to see whether there is OpenGL: the cameras make their own
    SynthOptions size;
    size.width = 160;
    size.height = 120;
    options_.lenses.left = synth_lens(size, false);
    options_.lenses.right = synth_lens(size, true);
    options_.sensor.noise = 0;
    options_.light_coarser = 8;
    options_.rate = 20;
    world_ = std::make_shared<const LiveLab>(LiveLab::Options{0.004, 1, {}});
    stereo_ = std::make_shared<MockStereo>(
        world_, [this](std::string_view joint, RobotTime t) { return shafts_in_motion(joint, to_seconds(t - start_)); },
        options_, clock_);
  }

  MonotonicClock clock_;
  RobotTime start_ = clock_.now();
  MockCameraOptions options_;
  std::shared_ptr<const LiveLab> world_;
  std::shared_ptr<MockStereo> stereo_;
};

TEST_F(MockCameraTest, PairsShowTheWorldAtTheirCaptureTime) {
  StereoCamera cameras(std::make_unique<MockCamera>("left", Side::left, stereo_),
                       std::make_unique<MockCamera>("right", Side::right, stereo_), clock_);
  cameras.start();
  const LightMap light(world_->lab(), options_.light_coarser);
  const auto irradiance = light.lit(world_->true_state(shafts_at_rest, 0));
  const Renderer renderer(world_->lab(), light);
  RobotTime last{};
  for (int i = 0; i < 3; ++i) {
    std::this_thread::sleep_for(400ms);  // the head turns by some degrees
    const auto pair = cameras.take(5s);
    ASSERT_TRUE(pair);
    EXPECT_EQ(pair->left.time, pair->right.time);
    EXPECT_GT(pair->left.time, last);
    last = pair->left.time;
    const auto psnr = [&](const ColourImage& image, const Lens& lens, const Pose& T_left_camera, Duration late) {
      const ShaftPositions shafts = [&](std::string_view joint) {
        return shafts_in_motion(joint, to_seconds(image.time + late - start_));
      };
      const Picture truth =
          renderer.render(RayTable(lens), world_->T_world_left(shafts) * T_left_camera,
                          world_->true_state(shafts, to_seconds(image.time + late - stereo_->epoch())), irradiance);
      return cv::PSNR(options_.sensor.develop(truth.light, 0, 0), image.bgr);
    };
    const double left = psnr(pair->left, options_.lenses.left, Pose::Identity(), 0ns);
    const double right = psnr(pair->right, options_.lenses.right, options_.lenses.T_left_right, 0ns);
    EXPECT_GT(left, 27);
    EXPECT_GT(right, 27);
    EXPECT_GT(left, psnr(pair->left, options_.lenses.left, Pose::Identity(), 50ms) + 1);
    EXPECT_GT(left, psnr(pair->left, options_.lenses.left, Pose::Identity(), -50ms) + 1);
  }
  cameras.stop();
  EXPECT_STREQ(cameras.status().reason, "");
}

TEST_F(MockCameraTest, HasAnExposureAndRefusesOthers) {
  MockCamera camera("left", Side::left, stereo_);
  camera.start();
  const auto brightness = [&] {
    CameraFrame frame;
    cv::Mat bgr;
    for (int i = 0; i < 4; ++i) EXPECT_EQ(camera.wait_frame(5s, frame), CameraStatus::ok);
    EXPECT_EQ(to_bgr(frame, bgr), Conversion::ok);
    return cv::mean(bgr)[1];
  };
  // One eye open: the renderer serves it alone.
  const double usual = brightness();
  camera.set_control("exposure_time_absolute", MockStereo::kExposure / 4);
  EXPECT_LT(brightness(), usual - 30);
  EXPECT_EQ(camera.controls()[0].value, MockStereo::kExposure / 4);
  EXPECT_THROW(camera.set_control("exposure_time_absolute", 0), InputError);
  EXPECT_THROW(camera.set_control("gain", 1), InputError);
  camera.stop();
  CameraFrame frame;
  EXPECT_EQ(camera.wait_frame(1ms, frame), CameraStatus::lost);
  camera.start();  // again
  EXPECT_EQ(camera.wait_frame(5s, frame), CameraStatus::ok);
}

TEST_F(MockCameraTest, RefusesWhatCannotBe) {
  MockCameraOptions odd = options_;
  odd.rate = 0;
  const ShaftsAt shafts = [](std::string_view joint, RobotTime) { return shafts_at_rest(joint); };
  EXPECT_THROW(MockStereo(world_, shafts, odd, clock_), InputError);
  odd = options_;
  SynthOptions size;
  size.width = 161;
  odd.lenses.left = synth_lens(size, false);
  EXPECT_THROW(MockStereo(world_, shafts, odd, clock_), InputError);
}

}  // namespace
}  // namespace foresight::sim
