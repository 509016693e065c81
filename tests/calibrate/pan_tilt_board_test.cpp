// `foresight calibrate pan-tilt --images --board`: a head before one board, drawn as its camera sees it.
#include <gmock/gmock.h>

#include <numbers>
#include <opencv2/imgcodecs.hpp>

#include "calibration/formats/camera_formats.hpp"
#include "calibration/result/result_file.hpp"
#include "calibration/robot/pan_tilt.hpp"
#include "tests/calibrate/run_calibrate.hpp"
#include "tests/robot_calibration/synthetic_rig.hpp"
#include "tests/support/html_check.hpp"
#include "tests/target/drawn_board.hpp"

namespace foresight::pan_tilt_board_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::string kBoard = "chessboard:9x6:0.025";
const CameraModel kCamera640{640, 480, Distortion::radtan4, {640, 640, 319.5, 239.5}};

// Pan axis upwards, tilt axis to the left; the world is the board, 0.5 m ahead and turned.
PanTiltModel head_before_board() {
  PanTiltModel model;
  model.length_m = 0.03, model.twist_rad = -std::numbers::pi / 2 + 0.02;
  model.T_tilt_camera.linear() << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  model.T_tilt_camera.linear() = model.T_tilt_camera.linear() * rotation_of({0.02, -0.01, 0.03});
  model.T_tilt_camera.translation() = Eigen::Vector3d(0.04, -0.02, 0.01);
  Pose T_camera_board = Pose::Identity();
  T_camera_board.linear() = rotation_of({0.35, 0.4, 0.1});
  T_camera_board.translation() = Eigen::Vector3d(0, 0, 0.5) - T_camera_board.linear() * Eigen::Vector3d(0.1, 0.0625, 0);
  model.T_world_pan = (camera_pose(model, {}) * T_camera_board).inverse();
  return model;
}

class PanTiltBoard : public testing::Test {
 protected:
  PanTiltBoard() {
    write_cameras(CameraFormat::camera_info, {{kCamera640}}, folder_ / "camera.yaml", false);
    std::filesystem::create_directories(folder_ / "views");
  }
  // A picture, and its row; the rows come in another order than the pictures.
  void take(int number, double pan, double tilt) {
    const Pose T_camera_board = camera_pose(truth_, {pan, tilt, {}}).inverse();
    const std::string name = "head" + std::to_string(number) + ".png";
    cv::imwrite((folder_ / "views" / name).string(), draw_board_at(parse_board(kBoard), 640, 480, T_camera_board).grey);
    angles_ = name + " " + std::to_string(pan) + " " + std::to_string(tilt) + "\n" + angles_;
  }
  std::string solve() const {
    return run_calibrate({"pan-tilt", "--images", folder_ / "views", "--board", kBoard, "--angles",
                          folder_.write("angles.txt", angles_), "--camera", folder_ / "camera.yaml", "--out",
                          folder_ / "h.yaml", "--json", folder_ / "h.json", "--report", folder_ / "h.html", "--force"});
  }

  const TempFolder folder_;
  const PanTiltModel truth_ = head_before_board();
  std::string angles_;
};

double degrees_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return 57.29577951 * std::acos(std::min(1.0, std::abs(a.dot(b))));
}

TEST_F(PanTiltBoard, TheAxesComeBack) {
  int number = 0;
  for (const double pan : {-0.15, -0.08, 0.0, 0.08, 0.15})
    for (const double tilt : {-0.12, 0.12}) take(number++, pan, tilt + 0.1 * pan);
  cv::imwrite((folder_ / "views/head99.png").string(), cv::Mat(480, 640, CV_8U, cv::Scalar(140)));
  angles_ += "head99.png 0 0\n";
  ASSERT_EQ(solve(), "0");
  EXPECT_EQ(malformed(folder_.read("h.html")), "");
  const auto numbers = json_of(folder_, "h.json");
  EXPECT_EQ(numbers["poses"], 10);
  EXPECT_THAT(numbers["notes"].dump(), HasSubstr("head99.png is left out"));
  EXPECT_LT(numbers["loo_mm"], 0.5);
  EXPECT_LT(numbers["loo_mrad"], 1.5);
  const PanTiltModel found = read_pan_tilt(read_result(folder_ / "h.yaml", "pan-tilt").result);
  const auto tilt_axis = [](const PanTiltModel& m, double pan) -> Eigen::Vector3d {
    return m.T_world_pan.linear() * rotation_of({0, 0, pan}) * rotation_of({m.twist_rad, 0, 0}).col(2);
  };
  EXPECT_LT(degrees_between(found.T_world_pan.linear().col(2), truth_.T_world_pan.linear().col(2)), 0.3);
  for (const double tilt : {-0.1, 0.1}) {
    const PanTiltAngles unseen{0.11, tilt, {}};
    const Vector6d step = step_between(camera_pose(truth_, unseen), camera_pose(found, unseen));
    EXPECT_LT(step.tail<3>().norm(), 5e-4);
    EXPECT_LT(step.head<3>().norm(), 1e-3);
  }
  RecordProperty("tilt_axis_deg", std::to_string(degrees_between(tilt_axis(found, 0), tilt_axis(truth_, 0))));
}

TEST_F(PanTiltBoard, TooFewViewsAreRefused) {
  for (int i = 0; i < 5; ++i) take(i, 0.05 * i - 0.1, 0.1 * (i % 2));
  EXPECT_THAT(solve(), AllOf(HasSubstr("5 poses"), HasSubstr("8")));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "h.yaml"));
  angles_ = "0 0\n";
  EXPECT_THAT(solve(), AllOf(HasSubstr("--angles"), HasSubstr("1 row for 5 images")));
  angles_ = "0 0\n10 20\n1 2\n30 0\n0 0\n";
  EXPECT_THAT(solve(), HasSubstr("rad, not degrees"));
}

}  // namespace
}  // namespace foresight::pan_tilt_board_test
