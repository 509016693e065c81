// `foresight calibrate arm` on simulated sessions, written to files as users have them.
#include <gmock/gmock.h>

#include <fstream>

#include "calibration/formats/camera_formats.hpp"
#include "calibration/robot/joint_chain.hpp"
#include "calibration/robot/robot_results.hpp"
#include "tests/calibrate/run_calibrate.hpp"
#include "tests/robot_calibration/synthetic_rig.hpp"
#include "tests/support/folders.hpp"

namespace foresight {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::string kBoard = "chessboard:6x4:0.03";

std::string vnl(const CornerSet& corners) {
  std::string text = "# filename x y level\n";
  for (const BoardView& view : corners.views)
    for (const Corner& corner : view.corners)
      text += view.name + ".png " + std::to_string(corner.pixel.x()) + " " + std::to_string(corner.pixel.y()) + " 0\n";
  return text;
}

std::string rows(const std::vector<RobotPose>& poses, double unit = 1) {
  std::string text;
  for (const RobotPose& robot : poses) {
    const Eigen::Quaterniond q(robot.T_base_flange.linear());
    const Eigen::Vector3d p = unit * robot.T_base_flange.translation();
    for (const double value : {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()}) text += std::to_string(value) + " ";
    text += "\n";
  }
  return text;
}

std::string error_of(const std::string& result) {
  return result == "0" ? "no error" : result;
}

class Arm : public testing::Test {
 protected:
  HandEyeRig make(CameraMount mount) {
    HandEyeRig rig =
        make_rig(random_, {.mount = mount, .views = 9, .noise_px = 0.05, .noise_rad = 5e-5, .noise_m = 5e-5});
    corners_ = folder_.write("corners.vnl", vnl(rig.data.corners));
    return rig;
  }
  std::string arm(std::vector<std::string> more) const {
    more.insert(more.begin(), {"arm", "--corners", corners_, "--board", kBoard, "--json", folder_ / "a.json", "--out",
                               folder_ / "a.yaml", "--force"});
    return run_calibrate(more);
  }
  Pose result(const std::string& name) const { return read_result(folder_ / "a.yaml", "arm").result.pose(name); }

  const TempFolder folder_;
  Random random_{71};
  std::string corners_;
};

TEST_F(Arm, FindsAFixedAndAMovingCamera) {
  for (const CameraMount mount : {CameraMount::fixed, CameraMount::moving}) {
    const HandEyeRig rig = make(mount);
    const auto poses = folder_.write("poses.txt", rows(rig.data.poses));
    ASSERT_EQ(error_of(arm({"--poses", poses})), "no error");
    const auto numbers = json_of(folder_, "a.json");
    EXPECT_EQ(numbers["camera_mount"], to_string(mount));
    EXPECT_LT(numbers["loo_px"], 0.3);
    EXPECT_LT(step_between(result(name_of_X(mount)), rig.X).norm(), 5e-3);
    EXPECT_THAT(arm({"--poses", poses, "--camera-mount", mount == CameraMount::fixed ? "moving" : "fixed"}),
                AllOf(HasSubstr("contradicts images and poses"), HasSubstr("--camera-mount " + to_string(mount))));
  }
}

TEST_F(Arm, MillimetresAndInversePosesAreNamed) {
  const HandEyeRig rig = make(CameraMount::fixed);
  const auto millimetres = folder_.write("mm.txt", rows(rig.data.poses, 1000));
  ASSERT_EQ(error_of(arm({"--poses", millimetres})), "no error");
  EXPECT_LT(step_between(result("T_base_camera"), rig.X).norm(), 5e-3);
  EXPECT_THAT(json_of(folder_, "a.json")["notes"].dump(), HasSubstr("taken as millimetres"));
  EXPECT_THAT(arm({"--poses", millimetres, "--pose-unit", "m"}), HasSubstr("--pose-unit mm"));

  std::vector<RobotPose> inverse = rig.data.poses;
  for (RobotPose& pose : inverse) pose.T_base_flange = pose.T_base_flange.inverse();
  const auto poses = folder_.write("inverse.txt", rows(inverse));
  EXPECT_THAT(arm({"--poses", poses, "--camera-mount", "fixed"}), HasSubstr("say --invert-poses"));
  ASSERT_EQ(error_of(arm({"--poses", poses, "--camera-mount", "fixed", "--invert-poses"})), "no error");
  EXPECT_LT(step_between(result("T_base_camera"), rig.X).norm(), 5e-3);
}

TEST_F(Arm, GivesTheArmInTheHeadsFrame) {
  const HandEyeRig rig = make(CameraMount::fixed);
  const auto poses = folder_.write("poses.txt", rows(rig.data.poses));
  const PanTiltModel head = random_head(random_);
  write_result(folder_ / "head.yaml", {"pan-tilt", utc_now(), {}, "loo_mm", 0.1, {}}, to_yaml(head), true);
  ASSERT_EQ(error_of(arm({"--poses", poses, "--head", folder_ / "head.yaml", "--head-angles", "0.3", "-0.2"})),
            "no error");
  const Pose expected = head.T_world_pan.inverse() * camera_pose(head, {0.3, -0.2, {}}) * rig.X.inverse();
  EXPECT_LT(step_between(result("T_head_base"), expected).norm(), 5e-3);
  EXPECT_THAT(arm({"--poses", poses, "--head", folder_ / "head.yaml"}), HasSubstr("--head-angles"));
  EXPECT_THAT(arm({"--poses", poses, "--head", folder_ / "absent.yaml", "--head-angles", "0", "0"}),
              HasSubstr("absent.yaml"));
  const HandEyeRig moving = make(CameraMount::moving);
  EXPECT_THAT(arm({"--poses", folder_.write("p.txt", rows(moving.data.poses)), "--head", folder_ / "head.yaml",
                   "--head-angles", "0", "0"}),
              HasSubstr("the camera moves with the arm"));
}

// Encoders in microseconds since power-on, the camera in unix seconds: a swept arm whose camera stamps are 35 ms old.
TEST(TimeCommand, FromJointsOfAUrdf) {
  const TempFolder folder;
  const std::string urdf = source_folder() / "configs/arm.urdf";
  JointChain chain = read_joint_chain(urdf, "", "");
  Random random(72);
  const Pose X = random_pose(random, 3, 0.1), Y = random_pose(random, 3, 0.3);
  const auto positions = [&](double t) {
    std::vector<double> q;
    for (std::size_t j = 0; j < chain.joints.size(); ++j)
      q.push_back(0.3 * std::sin((0.7 + 0.31 * static_cast<double>(j)) * t + static_cast<double>(j * j)));
    return q;
  };
  std::string joints = "time", camera;
  for (std::size_t j = 0; j < chain.joints.size(); ++j) joints += ",q" + std::to_string(j);
  joints += "\n";
  for (int i = 0; i < 2500; ++i) {
    joints += std::to_string(1'000'000 + 10'000 * i);
    for (const double q : positions(0.01 * i)) joints += "," + std::to_string(q);
    joints += "\n";
  }
  for (int i = 0; i < 600; ++i) {
    const double t = 0.5 + i / 30.0;
    const Pose B = noisy(Y.inverse() * flange_pose(chain, positions(t), "test") * X, random, 2e-3, 1e-3);
    const Eigen::Quaterniond q(B.linear());
    camera += std::to_string(1 + t - 0.035);
    for (const double v : {B.translation().x(), B.translation().y(), B.translation().z(), q.x(), q.y(), q.z(), q.w()})
      camera += " " + std::to_string(v);
    camera += "\n";
  }
  const auto encoder_file = folder.write("joints.csv", joints), camera_file = folder.write("camera.txt", camera);
  ASSERT_EQ(run_calibrate({"time", "--joints", encoder_file, "--urdf", urdf, "--camera-poses", camera_file, "--json",
                           folder / "t.json"}),
            "0");
  const auto numbers = json_of(folder, "t.json");
  EXPECT_NEAR(numbers["offset_s"], 0.035, 4 * numbers["offset_sigma_s"].get<double>());
  EXPECT_LT(numbers["offset_sigma_s"], 2e-3);
  EXPECT_THAT(numbers["notes"].dump(), HasSubstr("taken as microseconds"));
  EXPECT_THAT(run_calibrate({"time", "--joints", encoder_file, "--urdf", urdf, "--camera-poses", camera_file,
                             "--time-unit", "ns"}),
              AllOf(HasSubstr("--poses"), HasSubstr("too short a stream"), HasSubstr("--time-unit")));
  EXPECT_THAT(run_calibrate({"time", "--joints", encoder_file, "--camera-poses", camera_file}), HasSubstr("--urdf"));
  EXPECT_THAT(run_calibrate({"time", "--camera-poses", camera_file}), HasSubstr("--joints"));
  EXPECT_THAT(run_calibrate({"time", "--poses", camera_file, "--camera-poses", camera_file, "--time-unit", "week"}),
              HasSubstr("week"));
}

TEST_F(Arm, FindsJointOffsets) {
  const std::string urdf = source_folder() / "configs/arm.urdf";
  JointChain chain = read_joint_chain(urdf, "", "");
  const std::vector<double> offsets{0, -0.008, 0.012, 0.006, -0.01, 0.009, 0};
  JointRig made = make_joint_rig(chain, offsets, random_);
  const std::size_t views = long_run() ? 25 : 16;
  made.rows.resize(views), made.rig.data.corners.views.resize(views);
  write_cameras(CameraFormat::camera_info, {{made.rig.camera}}, folder_ / "camera.yaml", true);
  corners_ = folder_.write("corners.vnl", vnl(made.rig.data.corners));
  std::string joints;  // named rows may come in any order
  for (std::size_t i = made.rows.size(); i-- > 0;) {
    joints += made.rig.data.corners.views[i].name + ".png";
    for (const double q : made.rows[i]) joints += " " + std::to_string(q);
    joints += "\n";
  }
  const auto rows = folder_.write("joints.txt", joints);
  ASSERT_EQ(error_of(arm({"--urdf", urdf, "--joints", rows, "--camera-mount", "fixed", "--board-sigma", "0", "--camera",
                          folder_ / "camera.yaml"})),
            "no error");
  const auto numbers = json_of(folder_, "a.json");
  ASSERT_EQ(numbers["joint_offsets"].size(), offsets.size());
  double squares = 0;
  for (std::size_t i = 1; i + 1 < offsets.size(); ++i) {
    const std::string name = chain.robot.joints[static_cast<std::size_t>(chain.joints[i])].name;
    const double sigma = numbers["sigmas"][name + "_offset"];
    const double off = (numbers["joint_offsets"][name].get<double>() - offsets[i]) / sigma;
    EXPECT_LT(std::abs(off), 3) << name;
    EXPECT_LT(std::abs(off * sigma), 4e-3) << name;
    EXPECT_LT(sigma, views == 25 ? 3e-3 : 8e-3) << name;
    squares += off * off;
  }
  RecordProperty("sum_of_squares_in_sigmas", std::to_string(squares));
}

TEST_F(Arm, WrongJointsAreNamed) {
  const HandEyeRig rig = make(CameraMount::fixed);
  const std::string urdf = source_folder() / "configs/arm.urdf";
  EXPECT_THAT(arm({"--urdf", urdf}), HasSubstr("--joints"));
  EXPECT_THAT(arm({"--urdf", urdf, "--joints", folder_.write("j.txt", "0 0 0 0 0 0 0\n")}),
              HasSubstr("1 rows for 9 images"));
  EXPECT_THAT(arm({"--urdf", urdf, "--joints", folder_.write("w.txt", "0 zero 0 0 0 0 0\n")}), HasSubstr("'zero'"));
  EXPECT_THAT(arm({}), HasSubstr("--poses"));
}

}  // namespace
}  // namespace foresight
