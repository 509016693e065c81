// The mock lab behind a rig's cameras.
#include "rig/open_stereo.hpp"

#include <gtest/gtest.h>

#include "tests/support/headless_test.hpp"

namespace foresight::open_stereo_test {
namespace {

class OpenStereoTest : public HeadlessTest {
 protected:
  void SetUp() override {
    HeadlessTest::SetUp();
    if (IsSkipped()) return;
    context_.reset();  // only to see whether there is OpenGL: the cameras make their own
    config_ = as_mock({});
    for (CameraConfig& camera : config_.cameras) camera.settings.rate = 1;
  }

  /// The left camera's image of an instant at which the mock lab's arm has moved.
  cv::Mat look(StereoCamera& cameras) {
    cameras.start_polled();
    clock_.sleep_until(clock_.now() + std::chrono::seconds(3));
    cameras.poll();
    const auto pair = cameras.take(Duration{0});
    cameras.stop();
    return pair ? pair->left.bgr : cv::Mat();
  }

  /// Likewise, of the same cameras in a world whose light moves along, or does not.
  cv::Mat look(bool moving_light) {
    sim::MockCameraOptions options = mock_options(config_);
    options.moving_light = moving_light;
    clock_ = {};
    const auto stereo = std::make_shared<sim::MockStereo>(opened_.mock->world(), moving_shafts({}), options, clock_);
    StereoCamera cameras(std::make_unique<sim::MockCamera>("left", Side::left, stereo),
                         std::make_unique<sim::MockCamera>("right", Side::right, stereo), clock_);
    return look(cameras);
  }

  SteppedClock clock_;
  StereoConfig config_;
  OpenStereo opened_;
};

// Who records the mock lab sees shadows of what moves there, and a lamp that throws them.
TEST_F(OpenStereoTest, InSteppedTimeShadowsMoveWithWhatThrowsThem) {
  opened_ = open_stereo(config_, moving_shafts({}), clock_);
  const cv::Mat seen = look(*opened_.cameras);
  ASSERT_FALSE(seen.empty());
  EXPECT_EQ(cv::norm(seen, look(true), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(seen, look(false), cv::NORM_INF), 20);
}

}  // namespace
}  // namespace foresight::open_stereo_test
