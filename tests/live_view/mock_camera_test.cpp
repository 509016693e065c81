// What the mock cameras show is true, in stepped time and in real time: slow machines skip instants then.
#include "sim/live_view/mock_camera.hpp"

#include <opencv2/imgproc.hpp>

#include "drivers/camera/stereo_camera.hpp"
#include "sim/picture.hpp"
#include "sim/synth_run.hpp"
#include "tests/support/headless_test.hpp"

namespace foresight::sim::mock_camera_test {
namespace {

using namespace std::chrono_literals;

constexpr Duration kHang = 120s;  // of the machine; on the slowest one an image takes a second

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
  }

  static const std::shared_ptr<const LiveLab>& world() {
    static const auto world = std::make_shared<const LiveLab>(LiveLab::Options{0.004, 1, {}});
    return world;
  }

  /// Its motion begins at the clock's present.
  std::shared_ptr<MockStereo> stereo_at(Clock& clock) const {
    return std::make_shared<MockStereo>(
        world(),
        [start = clock.now()](std::string_view joint, RobotTime t) {
          return shafts_in_motion(joint, to_seconds(t - start));
        },
        options_, clock);
  }

  /// What the world looked like `late` after `image` was taken, against the image.
  double psnr(const MockStereo& stereo, const ColourImage& image, Side side, Duration late = 0ns) {
    if (!light_) {
      light_.emplace(world()->lab(), options_.light_coarser);
      irradiance_ = light_->lit(world()->true_state(shafts_at_rest, 0));
      renderer_.emplace(world()->lab(), *light_);
    }
    const double t = to_seconds(image.time + late - stereo.epoch());
    const ShaftPositions shafts = [&](std::string_view joint) { return shafts_in_motion(joint, t); };
    const Pose T_left_camera = side == Side::left ? Pose::Identity() : options_.lenses.T_left_right;
    const Picture truth =
        renderer_->render(RayTable(side == Side::left ? options_.lenses.left : options_.lenses.right),
                          world()->T_world_left(shafts) * T_left_camera, world()->true_state(shafts, t), irradiance_);
    return cv::PSNR(options_.sensor.develop(truth.light, 0, 0), image.bgr);
  }

  MockCameraOptions options_;

 private:
  std::optional<LightMap> light_;
  LightMap::Irradiance irradiance_;
  std::optional<Renderer> renderer_;
};

TEST_F(MockCameraTest, PairsShowTheWorldAtTheirCaptureTime) {
  SteppedClock clock;
  const auto stereo = stereo_at(clock);
  StereoCamera cameras(std::make_unique<MockCamera>("left", Side::left, stereo),
                       std::make_unique<MockCamera>("right", Side::right, stereo), clock);
  cameras.start_polled();
  for (int i = 1; i <= 3; ++i) {
    clock.sleep_until(RobotTime{} + i * 400ms);  // the head turns by some degrees
    cameras.poll();
    const auto pair = cameras.take(0ms);
    ASSERT_TRUE(pair);
    EXPECT_EQ(pair->left.time, clock.now() - 4ms) << "8 ms exposure";
    EXPECT_EQ(pair->left.time, pair->right.time);
    const double left = psnr(*stereo, pair->left, Side::left);
    EXPECT_GT(left, 27);
    EXPECT_GT(psnr(*stereo, pair->right, Side::right), 27);
    EXPECT_GT(left, psnr(*stereo, pair->left, Side::left, 50ms) + 1);
    EXPECT_GT(left, psnr(*stereo, pair->left, Side::left, -50ms) + 1);
    EXPECT_STREQ(cameras.status().reason, "");
  }
}

TEST_F(MockCameraTest, ShadowsMoveWithWhatThrowsThem) {
  const auto bright = [](std::string_view joint, RobotTime t) {
    return shafts_in_motion(joint, to_seconds(t - RobotTime{}));
  };
  const auto against_truth = [&](bool moving) {
    options_.moving_light = moving;
    SteppedClock clock;
    const auto stereo = std::make_shared<MockStereo>(world(), bright, options_, clock);
    MockCamera camera("left", Side::left, stereo);
    camera.start();
    clock.sleep_until(RobotTime{} + 3s);  // the hand is down at the mat
    CameraFrame frame;
    EXPECT_EQ(camera.wait_frame(1s, frame), CameraStatus::ok);
    cv::Mat bgr;
    EXPECT_EQ(to_bgr(frame, bgr), Conversion::ok);
    const ShaftPositions shafts = [&](std::string_view joint) { return bright(joint, frame.time); };
    const LabState state = world()->true_state(shafts, to_seconds(frame.time - RobotTime{}));
    const LightMap light(world()->lab(), options_.light_coarser);
    const Picture truth =
        Renderer(world()->lab(), light)
            .render(RayTable(options_.lenses.left), world()->T_world_left(shafts), state, light.lit(state));
    return cv::PSNR(options_.sensor.develop(truth.light, 0, 0), bgr);
  };
  const double moving = against_truth(true);
  EXPECT_GT(moving, 27);
  EXPECT_GT(moving, against_truth(false) + 1);
}

TEST_F(MockCameraTest, InRealTimeImagesAreTrueToo) {
  MonotonicClock clock;
  const auto stereo = stereo_at(clock);
  MockCamera left("left", Side::left, stereo), right("right", Side::right, stereo);
  left.start();
  right.start();
  RobotTime last{};  // of the left one
  for (MockCamera* camera : {&left, &right, &left}) {
    CameraFrame frame;
    ASSERT_EQ(camera->wait_frame(kHang, frame), CameraStatus::ok);
    EXPECT_LT(frame.time, clock.now());
    if (camera == &left) {
      EXPECT_GT(frame.time, std::exchange(last, frame.time));
    }
    ColourImage image;
    ASSERT_EQ(to_bgr(frame, image.bgr), Conversion::ok);
    image.time = frame.time;
    EXPECT_GT(psnr(*stereo, image, camera == &left ? Side::left : Side::right), 27);
  }
  EXPECT_EQ(left.counters().frames, 2u);
}

TEST_F(MockCameraTest, HasAnExposureAndRefusesOthers) {
  SteppedClock clock;
  const auto stereo = stereo_at(clock);
  MockCamera camera("left", Side::left, stereo);
  camera.start();
  const auto brightness = [&] {
    CameraFrame frame;
    cv::Mat bgr;
    EXPECT_EQ(camera.wait_frame(1s, frame), CameraStatus::ok);
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
  EXPECT_EQ(camera.wait_frame(1s, frame), CameraStatus::ok);
}

TEST_F(MockCameraTest, RefusesWhatCannotBe) {
  SteppedClock clock;
  MockCameraOptions odd = options_;
  odd.rate = 0;
  const ShaftsAt shafts = [](std::string_view joint, RobotTime) { return shafts_at_rest(joint); };
  EXPECT_THROW(MockStereo(world(), shafts, odd, clock), InputError);
  odd = options_;
  SynthOptions size;
  size.width = 161;
  odd.lenses.left = synth_lens(size, false);
  EXPECT_THROW(MockStereo(world(), shafts, odd, clock), InputError);
}

}  // namespace
}  // namespace foresight::sim::mock_camera_test
