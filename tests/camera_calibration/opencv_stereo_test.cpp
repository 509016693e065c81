// OpenCV's own stereo set with frozen corners; the figures to reach are mrcal 2.2's.
#include <gtest/gtest.h>

#include <cstdlib>

#include "calibration/camera/camera_calibration.hpp"
#include "calibration/camera/input_checks.hpp"
#include "calibration/target/corner_files.hpp"
#include "tests/support/folders.hpp"

namespace foresight::opencv_stereo_test {
namespace {

std::filesystem::path corner_folder() {
  return data_folder() / "opencv_stereo_corners";
}

RigViews read(const std::string& name) {
  RigViews views = rig_views(read_stereo_corners(corner_folder() / name, parse_board("chessboard:9x6:1")));
  views.width = {640, 640};
  views.height = {480, 480};
  return views;
}

class OpenCvStereo : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(corner_folder()))
      GTEST_SKIP() << "no corners at " << corner_folder() << "; set FORESIGHT_DATA";
  }
};

TEST_F(OpenCvStereo, FlatBoardAndPlainLeastSquaresAreOpenCvs) {
  CameraCalibrationOptions options;
  options.model = Distortion::radtan4;
  options.warp = false;
  options.solver.loss_sigmas = 0;
  options.solver.reject_sigmas = 100;
  const RigViews views = read("corners_pc25.vnl");
  const CameraCalibration c = calibrate_rig(views, subset(views, {}), options);
  // cv::stereoCalibrate with k3 fixed, the same scores: .1978 .2066 .2659 .1138
  EXPECT_NEAR(c.solution.rms_px, 0.1978, 0.0002);
  EXPECT_NEAR(c.held_out.joint_px, 0.2066, 0.0002);
  EXPECT_NEAR(c.held_out.cross_px, 0.2659, 0.0003);
  EXPECT_NEAR(c.held_out.epipolar_px, 0.1138, 0.0002);
}

TEST_F(OpenCvStereo, BestCorners) {
  const RigViews views = read("corners_pc25.vnl");
  const CameraCalibration c = calibrate_rig(views, subset(views, {}), {});
  EXPECT_TRUE(c.usable()) << c.full();
  EXPECT_EQ(c.solution.rig.cameras[0].distortion, Distortion::radtan4) << "no richer model predicts better";
  EXPECT_LE(c.solution.rms_px, 0.193);
  EXPECT_LE(c.solution.rejected.size(), 2u);
  EXPECT_LE(c.held_out.joint_px, 0.2025);
  EXPECT_LE(c.held_out.cross_px, 0.2665);
  EXPECT_LE(c.held_out.epipolar_px, 0.1142);
  EXPECT_EQ(c.held_out.views, 13);
  // mrcal's projection uncertainty; within 15 % at centre and middle.
  EXPECT_NEAR(c.at_infinity[0].centre_px, 0.082, 0.15 * 0.082);
  EXPECT_NEAR(c.at_infinity[0].median_px, 0.150, 0.15 * 0.150);
  EXPECT_NEAR(c.at_infinity[1].centre_px, 0.097, 0.15 * 0.097);
  EXPECT_NEAR(c.at_infinity[1].median_px, 0.151, 0.15 * 0.151);
}

TEST_F(OpenCvStereo, PoorCornersScoredOnTheBest) {
  CameraCalibrationOptions options;
  options.model = Distortion::radtan4;
  const CameraCalibration c = calibrate_rig(read("corners_11.vnl"), read("corners_pc25.vnl"), options);
  EXPECT_LE(c.held_out.joint_px, 0.206);
  EXPECT_LE(c.held_out.cross_px, 0.272);
}

TEST_F(OpenCvStereo, GuessesTheImageSize) {
  RigViews views = read("corners_pc25.vnl");
  views.width = views.height = {0, 0};
  EXPECT_EQ(usual_size(views, 0), (std::array{640, 480}));
}

}  // namespace
}  // namespace foresight::opencv_stereo_test
