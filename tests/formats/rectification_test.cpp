// Rectified pairs as other programs use them: our files go through OpenCV's own functions.
#include "calibration/formats/rectification.hpp"

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/camera/rig.hpp"
#include "scene/yaml_fields.hpp"
#include "tests/formats/example_cameras.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::rectification_test {
namespace {

struct CvSide {
  cv::Mat K, D, R, P;
};

/// As a user of OpenCV reads our file.
std::array<CvSide, 2> read_opencv_file(const std::string& file) {
  const cv::FileStorage storage(file, cv::FileStorage::READ);
  std::array<CvSide, 2> out;
  for (const std::size_t side : {0u, 1u}) {
    const std::string n = std::to_string(side + 1);
    storage["M" + n] >> out[side].K, storage["D" + n] >> out[side].D;
    storage["R" + n] >> out[side].R, storage["P" + n] >> out[side].P;
  }
  return out;
}

/// As ROS' image_geometry reads a camera_info.
CvSide read_camera_info_file(const std::string& file) {
  const YamlMap yaml = YamlMap::load(file);
  const auto matrix = [&](const char* key, int rows) {
    return cv::Mat(yaml.map(key).numbers("data"), true).reshape(1, rows);
  };
  return {matrix("camera_matrix", 3), matrix("distortion_coefficients", 1), matrix("rectification_matrix", 3),
          matrix("projection_matrix", 3)};
}

cv::Point2d undistorted(const Eigen::Vector2d& pixel, const CvSide& side, bool fish_eye) {
  std::vector<cv::Point2d> in{{pixel.x(), pixel.y()}}, out;
  const cv::TermCriteria exact(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 200, 1e-14);
  if (fish_eye)
    cv::fisheye::undistortPoints(in, out, side.K, side.D, side.R, side.P);
  else
    cv::undistortPoints(in, out, side.K, side.D, side.R, side.P, exact);
  return out[0];
}

/// Points before both cameras lie in one row of the rectified images, and their disparity tells their depth there.
void expect_aligned(const CalibratedCameras& pair, const std::array<CvSide, 2>& sides, const std::string& name) {
  SCOPED_TRACE(name);
  const bool fish_eye = pair.left().distortion == Distortion::equidistant;
  const double f = sides[0].P.at<double>(0, 0), tx = sides[1].P.at<double>(0, 3);
  EXPECT_NEAR(-tx / f, pair.T_left_right.translation().norm(), 1e-9) << "Tx is -fx times the baseline";
  EXPECT_EQ(sides[0].P.at<double>(0, 3), 0);
  for (const Eigen::Vector3d& p_left :
       {Eigen::Vector3d(0, 0, 0.6), Eigen::Vector3d(0.15, -0.1, 0.8), Eigen::Vector3d(-0.2, 0.12, 1.2)}) {
    const auto l = project(pair.left(), p_left), r = project(pair.right(), to_camera(pair, 1, p_left));
    ASSERT_TRUE(l && r);
    const cv::Point2d left = undistorted(*l, sides[0], fish_eye), right = undistorted(*r, sides[1], fish_eye);
    EXPECT_NEAR(left.y, right.y, 1e-3);
    const cv::Mat R = sides[0].R;
    const double depth =
        R.at<double>(2, 0) * p_left.x() + R.at<double>(2, 1) * p_left.y() + R.at<double>(2, 2) * p_left.z();
    EXPECT_NEAR(-tx / (left.x - right.x), depth, 1e-3 * depth);
  }
}

TEST(Rectification, PointsLieInOneRow) {
  const TempFolder folder;
  for (const Distortion model : {Distortion::radtan4, Distortion::radtan5, Distortion::rational, Distortion::thin_prism,
                                 Distortion::equidistant}) {
    const std::string name = to_string(model);
    CalibratedCameras pair = example_pair(model);
    if (model == Distortion::rational || model == Distortion::thin_prism)
      for (std::size_t i = 9; i < 12; ++i) pair.cameras[0].lens[i] = pair.cameras[1].lens[i] = 1e-4;
    write_cameras(CameraFormat::opencv, pair, folder / (name + ".yml"), false);
    expect_aligned(pair, read_opencv_file(folder / (name + ".yml")), name + ", opencv");
    if (model == Distortion::thin_prism) continue;
    write_cameras(CameraFormat::camera_info, pair, folder / name, false);
    expect_aligned(pair,
                   {read_camera_info_file(folder / name / "camera.yaml"),
                    read_camera_info_file(folder / name / "camera_right.yaml")},
                   name + ", camera-info");
  }
}

// OpenCV's own stereoRectify, from the M, D, R and T of our file, gives the R1, R2, P1, P2 and Q that stand beside
// them.
TEST(Rectification, IsWhatOpenCvFindsItself) {
  const TempFolder folder;
  write_cameras(CameraFormat::opencv, example_pair(Distortion::radtan5), folder / "pair.yml", false);
  const cv::FileStorage storage(folder / "pair.yml", cv::FileStorage::READ);
  const auto read = [&](const char* key) {
    cv::Mat m;
    storage[key] >> m;
    EXPECT_FALSE(m.empty()) << key;
    return m;
  };
  cv::Mat R1, R2, P1, P2, Q;
  cv::stereoRectify(read("M1"), read("D1"), read("M2"), read("D2"), {640, 480}, read("R"), read("T"), R1, R2, P1, P2, Q,
                    cv::CALIB_ZERO_DISPARITY, 0);
  for (const auto& [key, ours] : {std::pair{"R1", R1}, {"R2", R2}, {"P1", P1}, {"P2", P2}, {"Q", Q}})
    EXPECT_LT(cv::norm(read(key), ours, cv::NORM_INF), 1e-9) << key;
}

TEST(Rectification, PairsOfUnlikeCamerasAreWrittenAsTheyAre) {
  const TempFolder folder;
  CalibratedCameras pair = example_pair(Distortion::radtan4);
  pair.cameras[1].width = 320;
  write_cameras(CameraFormat::camera_info, pair, folder / "c", false);
  const CvSide right = read_camera_info_file(folder / "c/camera_right.yaml");
  EXPECT_EQ(cv::norm(right.R, cv::Mat::eye(3, 3, CV_64F), cv::NORM_INF), 0);
  EXPECT_EQ(right.P.at<double>(0, 3), 0);
}

}  // namespace
}  // namespace foresight::rectification_test
