// `foresight calibrate arm` on simulated sessions, written to files as users have them.
#include <gmock/gmock.h>

#include <fstream>

#include "calibration/camera/camera_result.hpp"
#include "calibration/formats/camera_formats.hpp"
#include "calibration/formats/urdf_offsets.hpp"
#include "calibration/result/result_file.hpp"
#include "calibration/robot/joint_chain.hpp"
#include "calibration/robot/robot_results.hpp"
#include "tests/calibrate/run_calibrate.hpp"
#include "tests/robot_calibration/synthetic_rig.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/html_check.hpp"

namespace foresight::arm_test {
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

// The file keeps what it had, and the numbers say why.
TEST_F(Arm, PosesThatChangedPlacesEndWithAVerdict) {
  HandEyeRig rig = make(CameraMount::fixed);
  std::swap(rig.data.poses[2], rig.data.poses[6]);
  const auto poses = folder_.write("poses.txt", rows(rig.data.poses));
  EXPECT_EQ(arm({"--poses", poses, "--report", folder_ / "a.html"}), "1");
  const auto numbers = json_of(folder_, "a.json");
  EXPECT_EQ(numbers["usable"], false);
  EXPECT_THAT(numbers["not_usable"].dump(),
              AllOf(HasSubstr("view2"), HasSubstr("view6"), HasSubstr("are exchanged"), HasSubstr("--poses")));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.yaml"));
  const std::string page = folder_.read("a.html");
  EXPECT_EQ(malformed(page), "");
  EXPECT_LT(page.find("Not usable"), page.find("<table")) << "the verdict stands before all else";
  std::swap(rig.data.poses[2], rig.data.poses[6]);
  folder_.write("poses.txt", rows(rig.data.poses));
  ASSERT_EQ(error_of(arm({"--poses", poses})), "no error");
  EXPECT_THAT(folder_.read("a.yaml"), HasSubstr("verdict: usable"));
}

TEST_F(Arm, VerifyKnowsItsOwnViewsWhateverTheyAreCalled) {
  HandEyeRig rig = make_rig(
      random_, {.mount = CameraMount::moving, .views = 18, .noise_px = 0.05, .noise_rad = 5e-5, .noise_m = 5e-5});
  const HandEyeData all = rig.data;
  const auto part = [&](std::size_t from, std::size_t to, const std::string& name) {
    HandEyeData some = all;
    some.corners.views = {all.corners.views.begin() + std::ptrdiff_t(from),
                          all.corners.views.begin() + std::ptrdiff_t(to)};
    some.poses = {all.poses.begin() + std::ptrdiff_t(from), all.poses.begin() + std::ptrdiff_t(to)};
    for (std::size_t v = 0; v < some.corners.views.size(); ++v) some.corners.views[v].name = name + std::to_string(v);
    folder_.write(name + ".vnl", vnl(some.corners));
    folder_.write(name + ".txt", rows(some.poses));
  };
  part(0, 12, "solved"), part(0, 12, "renamed"), part(8, 18, "both"), part(12, 18, "new");
  corners_ = folder_ / "solved.vnl";
  EXPECT_EQ(error_of(arm({"--poses", folder_ / "solved.txt"})), "no error");
  EXPECT_THAT(run_calibrate({"verify", "--result", folder_ / "a.yaml", "--corners", folder_ / "new.vnl", "--board",
                             kBoard, "--poses", folder_ / "new.txt"}),
              HasSubstr("--camera"))
      << "corners do not tell the size of the images that the lens is of";
  write_cameras(CameraFormat::camera_info, {{rig.camera}}, folder_ / "camera.yaml", true);
  ASSERT_EQ(error_of(arm({"--poses", folder_ / "solved.txt", "--camera", folder_ / "camera.yaml"})), "no error");
  const auto verify = [&](const std::string& name) {
    const std::string code =
        run_calibrate({"verify", "--result", folder_ / "a.yaml", "--corners", folder_ / (name + ".vnl"), "--board",
                       kBoard, "--poses", folder_ / (name + ".txt"), "--json", folder_ / "v.json"});
    return std::pair(code, json_of(folder_, "v.json"));
  };
  const auto [code, numbers] = verify("renamed");
  EXPECT_EQ(code, "1");
  EXPECT_EQ(numbers["views_of_the_calibration"], 12);
  EXPECT_THAT(numbers["failed_because"].dump(), HasSubstr("take new pictures"));
  EXPECT_EQ(verify("new").first, "0");
  EXPECT_EQ(verify("new").second["views"], 6);
  EXPECT_EQ(verify("both").first, "0");
  EXPECT_EQ(verify("both").second["views"], 6) << "four of them are known";
  rig.data.poses.resize(6);
  for (std::size_t v = 0; v < 6; ++v)  // the camera was bumped
    rig.data.poses[v].T_base_flange = all.poses[12 + v].T_base_flange * random_pose(random_, 0.02, 0.002);
  folder_.write("new.txt", rows(rig.data.poses));
  EXPECT_EQ(verify("new").first, "1");
}

// The lens that was found goes to others, and the camera onto whatever link carries it.
TEST_F(Arm, ExportsTheLensAndAttachesToALink) {
  const HandEyeRig rig = make(CameraMount::moving);
  write_cameras(CameraFormat::camera_info, {{rig.camera}}, folder_ / "camera.yaml", true);
  ASSERT_EQ(error_of(arm({"--poses", folder_.write("poses.txt", rows(rig.data.poses)), "--camera",
                          folder_ / "camera.yaml", "--camera-link", "eye"})),
            "no error");
  ASSERT_EQ(run_calibrate({"export", folder_ / "a.yaml", "--to", "camera-info", "--out", folder_ / "lens.yaml"}), "0");
  EXPECT_LT(worst_ray({{rig.camera}}, read_cameras(CameraFormat::camera_info, folder_ / "lens.yaml"), 100), 1e-6);
  const std::string urdf = source_folder() / "configs/arm.urdf";
  const std::vector<std::string> to_urdf{"export", folder_ / "a.yaml",  "--to", "urdf", "--urdf", urdf,
                                         "--out",  folder_ / "arm.urdf"};
  EXPECT_THAT(run_calibrate(to_urdf), HasSubstr("no link 'flange'"));
  std::vector<std::string> attached = to_urdf;
  attached.insert(attached.end(), {"--link", "arm_7"});
  ASSERT_EQ(run_calibrate(attached), "0");
  const UrdfMount mount = read_mount(folder_.read("arm.urdf"), "eye", "arm.urdf");
  EXPECT_EQ(mount.parent, "arm_7");
  EXPECT_LT(step_between(mount.T_parent_child, result("T_flange_camera")).norm(), 1e-9);
}

// One camera of a pair watches the arm: its lens is in the pair's result.
TEST_F(Arm, TakesTheLensOfItsSideFromAPair) {
  const HandEyeRig rig = make(CameraMount::fixed);
  const auto poses = folder_.write("poses.txt", rows(rig.data.poses));
  CameraModel other = rig.camera;
  other.lens[0] *= 1.1, other.lens[1] *= 1.1;
  const auto lens_taken = [&](const CalibratedCameras& pair, const std::string& side) {
    write_result(folder_ / "pair.yaml", {"stereo", utc_now(), {}, "loo_joint_px", 0.1, {}}, to_yaml(pair), true);
    EXPECT_EQ(error_of(arm({"--poses", poses, "--camera", folder_ / "pair.yaml", "--side", side})), "no error");
    const auto numbers = json_of(folder_, "a.json");
    EXPECT_THAT(numbers["notes"].dump(), HasSubstr("the " + side + " lens of "));
    EXPECT_EQ(numbers["camera_given"], true);
    return numbers["fx_px"].get<double>();
  };
  const Pose T = Pose(Eigen::Translation3d(0.1, 0, 0));
  EXPECT_EQ(lens_taken({{rig.camera, other}, T}, "left"), rig.camera.lens[0]);
  EXPECT_EQ(lens_taken({{other, rig.camera}, T}, "right"), rig.camera.lens[0]);
  std::filesystem::copy_file(folder_ / "a.yaml", folder_ / "earlier.yaml");
  ASSERT_EQ(error_of(arm({"--poses", poses, "--camera", folder_ / "earlier.yaml"})), "no error");
  EXPECT_EQ(json_of(folder_, "a.json")["fx_px"], rig.camera.lens[0]) << "of an earlier result of arm";
  const PanTiltModel head = random_head(random_);
  write_result(folder_ / "head.yaml", {"pan-tilt", utc_now(), {}, "loo_mm", 0.1, {}}, to_yaml(head), true);
  EXPECT_THAT(arm({"--poses", poses, "--camera", folder_ / "head.yaml"}),
              AllOf(HasSubstr("kind 'pan-tilt', which has no lens"), HasSubstr("calibrate intrinsics")));
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
  std::string joints = "image";  // rows and columns that are named may come in any order
  for (std::size_t j = chain.joints.size(); j-- > 0;)
    joints += "," + chain.robot.joints[static_cast<std::size_t>(chain.joints[j])].name;
  joints += ",finger\n";
  for (std::size_t i = made.rows.size(); i-- > 0;) {
    joints += made.rig.data.corners.views[i].name + ".png";
    for (std::size_t j = made.rows[i].size(); j-- > 0;) joints += "," + std::to_string(made.rows[i][j]);
    joints += ",0.01\n";
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
              HasSubstr("1 row for 9 images"));
  EXPECT_THAT(arm({"--urdf", urdf, "--joints", folder_.write("w.txt", "0 zero 0 0 0 0 0\n")}), HasSubstr("'zero'"));
  EXPECT_THAT(arm({"--urdf", urdf, "--joints", folder_.write("t.csv", "time_s,shoulder_yaw\n0,0\n")}),
              HasSubstr("--run RUN"));
  EXPECT_THAT(arm({"--urdf", urdf, "--joints", folder_.write("n.csv", "image,shoulder_yaw,elbov\nview0,0,0\n")}),
              HasSubstr("no joint 'shoulder_pitch'"));
  EXPECT_THAT(arm({"--guided"}), HasSubstr("--rig"));
  EXPECT_THAT(arm({}), HasSubstr("--poses"));
}

}  // namespace
}  // namespace foresight::arm_test
