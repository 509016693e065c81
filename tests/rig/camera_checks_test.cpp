// What `foresight doctor` says of a rig's cameras, in stepped time.
#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "apps/doctor/findings.hpp"
#include "common/clock.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::doctor::camera_checks_test {
namespace {

using testing::HasSubstr;

class CameraChecks : public testing::Test {
 protected:
  CameraChecks() {
    for (int i = 0; i < 3; ++i)
      folder_.write("image_" + std::to_string(i) + ".png",
                    encoded(".png", cv::Mat(12, 16, CV_8UC3, cv::Scalar::all(9))));
    CameraConfig& left = config_.cameras[0];
    left.driver = CameraDriver::images;
    left.device = folder_.path();
    left.settings.rate = 20;
  }

  SteppedClock clock_;
  TempFolder folder_;
  StereoConfig config_;
};

TEST_F(CameraChecks, TellRateAndAge) {
  const Findings found = check_camera(config_, Side::left, clock_);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].verdict, Verdict::good);
  EXPECT_EQ(found[0].subject, "camera left");
  EXPECT_EQ(found[0].what, "16 x 12 bgr, 20.0 images per second");
  EXPECT_EQ(found[1].verdict, Verdict::good);
  EXPECT_EQ(found[1].what, "its images are 0 to 0 ms old when they come");
}

TEST_F(CameraChecks, NameDamageAndSilence) {
  folder_.write("image_1.png", encoded(".png", cv::Mat(10, 16, CV_8UC3, cv::Scalar::all(9))));
  const Findings damaged = check_camera(config_, Side::left, clock_);
  ASSERT_EQ(damaged.size(), 3u);
  EXPECT_EQ(damaged[0].verdict, Verdict::poor) << "a third of the images is no use";
  EXPECT_THAT(damaged[1].what, HasSubstr("damaged images"));

  config_.cameras[0].settings.rate = 0.2;  // none within the time of the check
  const Findings silent = check_camera(config_, Side::left, clock_);
  ASSERT_EQ(silent.size(), 1u);
  EXPECT_EQ(silent[0].verdict, Verdict::bad);
  EXPECT_EQ(silent[0].what, "delivers no images");

  config_.cameras[0].device = folder_ / "none";
  EXPECT_EQ(check_camera(config_, Side::left, clock_).at(0).verdict, Verdict::bad);
}

}  // namespace
}  // namespace foresight::doctor::camera_checks_test
