// Views that cannot tell everything apart: the message names what the boards would have to do.
#include <gmock/gmock.h>

#include "calibration/camera/camera_calibration.hpp"
#include "tests/camera_calibration/synthetic_rig.hpp"

namespace foresight::missing_motion_test {
namespace {

using test::synthetic_rig;
using testing::AllOf;
using testing::HasSubstr;

CameraCalibration calibrated(const test::SyntheticOptions& boards) {
  const auto s = synthetic_rig(9, boards);
  CameraCalibrationOptions options;
  options.model = Distortion::radtan4;
  return calibrate_rig(s.views, subset(s.views, {}), options);
}

void expect_missing(const test::SyntheticOptions& boards, const std::string& what, const std::string& cure) {
  const CameraCalibration c = calibrated(boards);
  EXPECT_FALSE(c.usable());
  EXPECT_THAT(c.verdict.text(), AllOf(HasSubstr(what), HasSubstr(cure))) << c.full();
}

TEST(MissingMotion, BoardsParallelToTheImage) {
  expect_missing({.views = 12, .cameras = 1, .most_tilt = 0}, "parallel to the image", "tilt the board");
}

TEST(MissingMotion, BoardsParallelToTheImageAtOneDistance) {
  expect_missing({.views = 12, .cameras = 1, .most_tilt = 0, .nearest_m = 0.6, .depth_m = 0}, "parallel to the image",
                 "focal length and distance cannot be told apart");
}

TEST(MissingMotion, BoardsParallelToEachOther) {
  expect_missing({.views = 12, .cameras = 1, .most_tilt = 0, .lean = {0.4, 0.3, 0}}, "parallel to each other",
                 "turn the board about both axes");
}

TEST(MissingMotion, BoardsTiltedALittleAboutOneAxis) {
  expect_missing({.views = 6, .cameras = 1, .noise_px = 0.4, .most_tilt = 0.25, .turn = false, .one_axis = 0},
                 "tilted about one axis only", "about the other one too");
}

TEST(MissingMotion, BoardsInTheMiddleLeaveTheDistortionOpen) {
  expect_missing({.views = 15, .cameras = 1, .nearest_m = 1.3, .depth_m = 0.2, .spread = 0.02}, "% of the image",
                 "to all sides");
}

TEST(MissingMotion, NamesTheCameraOfAPair) {
  expect_missing({.views = 12, .most_tilt = 0}, "the left camera: all boards are parallel to the image", "tilt");
}

TEST(MissingMotion, NothingIsMissingOfGoodViews) {
  EXPECT_TRUE(calibrated({.views = 15, .cameras = 1}).usable());
}

}  // namespace
}  // namespace foresight::missing_motion_test
