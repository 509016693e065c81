#include "calibration/formats/urdf_offsets.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>

#include "common/error.hpp"
#include "scene/urdf_reader.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::urdf_offsets_test {
namespace {

using testing::HasSubstr;

constexpr const char* kArm = R"(<?xml version="1.0"?>
<!-- an arm -->
<robot name="arm">
  <link name="base"/><link name="upper"><visual><geometry><box size="0.1 0.1 0.3"/></geometry></visual></link>
  <link name="camera"/>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/>
    <origin xyz="0 0 0.2" rpy="0.1 0.2 0.3"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/>
  </joint>
  <joint name="mount" type="fixed"><parent link="upper"/><child link="camera"/><origin xyz="0.1 0 0"/></joint>
</robot>
)";

Pose random_pose(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Pose T = Pose::Identity();
  T.linear() = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                   .normalized()
                   .toRotationMatrix();
  T.translation() = Eigen::Vector3d(normal(random), normal(random), normal(random));
  return T;
}

std::string refusal(const std::string& urdf, const UrdfOffsets& offsets) {
  try {
    with_offsets(urdf, offsets, "arm.urdf");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// Wherever the joints' axes point in the robot's file, its camera stands where the head's model has it.
TEST(UrdfOffsets, AHeadDoesTheSameInAUrdf) {
  std::mt19937 random(5);
  constexpr const char* kTorso = R"(<robot name="r"><link name="torso"/><link name="neck"/><link name="face"/>
  <joint name="yaw" type="revolute"><parent link="torso"/><child link="neck"/><axis xyz="0 0.6 0.8"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="nod" type="revolute"><parent link="neck"/><child link="face"/><axis xyz="0 -1 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/></joint></robot>)";
  UrdfHead head;
  head.parent = "torso";
  head.T_parent_pan = random_pose(random), head.T_pan_tilt = random_pose(random),
  head.T_tilt_camera = random_pose(random);
  const TempFolder folder;
  for (const bool known : {false, true}) {
    if (known) head.joints = {"yaw", "nod"};
    UrdfOffsets offsets;
    offsets.head = head;
    const std::string text = with_offsets(known ? kTorso : empty_urdf("torso"), offsets, "r.urdf");
    UrdfRobot robot = read_urdf(folder.write("r.urdf", text), folder.path());
    pose_links(robot, {{head.joints[0], 0.4}, {head.joints[1], -0.7}}, "test");
    Pose T = Pose::Identity();
    auto link = static_cast<std::size_t>(
        std::find_if(robot.links.begin(), robot.links.end(), [&](const Node& n) { return n.name == head.camera; }) -
        robot.links.begin());
    for (; robot.links[link].parent >= 0; link = static_cast<std::size_t>(robot.links[link].parent))
      T = robot.links[link].T_parent_node * T;
    Pose expected = head.T_parent_pan;
    expected.rotate(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ()));
    expected = expected * head.T_pan_tilt;
    expected.rotate(Eigen::AngleAxisd(-0.7, Eigen::Vector3d::UnitZ()));
    expected = expected * head.T_tilt_camera;
    EXPECT_LT((T.matrix() - expected.matrix()).norm(), 1e-9) << known;
  }
  UrdfOffsets elsewhere;
  elsewhere.head = head;
  elsewhere.head->parent = "face";
  EXPECT_THAT(refusal(kTorso, elsewhere), HasSubstr("--link, 'torso'"));
}

TEST(UrdfOffsets, AMountHangsOnTheLinkThatTheUserNames) {
  std::mt19937 random(6);
  const Pose T = random_pose(random);
  EXPECT_EQ(attached({"flange", "eye", T}, "upper", kArm, "arm.urdf").parent, "upper");
  const UrdfMount moved = attached({"camera", "eye", T}, "upper", kArm, "arm.urdf");  // fixed, 0.1 m along x
  Pose expected = Pose::Identity();
  expected.translation().x() = 0.1;
  EXPECT_LT((moved.T_parent_child.matrix() - (expected * T).matrix()).norm(), 1e-12);
  try {
    attached({"camera", "eye", T}, "base", kArm, "arm.urdf");
    FAIL() << "a joint between them moves";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("move against each other"));
  }
}

TEST(UrdfOffsets, MountsReadBackAtEveryAttitude) {
  std::mt19937 random(4);
  std::vector<Pose> poses(50);
  for (Pose& T : poses) T = random_pose(random);
  poses[0].linear() = Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitY()).toRotationMatrix();
  poses[1].linear() = (Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()) *
                       Eigen::AngleAxisd(-std::numbers::pi / 2, Eigen::Vector3d::UnitY()))
                          .toRotationMatrix();
  poses[2].linear() = Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()).toRotationMatrix();
  for (const Pose& T : poses) {
    const std::string urdf = with_offsets(empty_urdf("left_camera"), {{{"left_camera", "right_camera", T}}, {}}, "u");
    const UrdfMount back = read_mount(urdf, "right_camera", "u");
    EXPECT_EQ(back.parent, "left_camera");
    EXPECT_LT((back.T_parent_child.matrix() - T.matrix()).cwiseAbs().maxCoeff(), 1e-14);
  }
}

// Our own reader, which uses urdfdom, poses the links of the result.
TEST(UrdfOffsets, TheEncoderThenPosesTheLink) {
  const TempFolder folder;
  const double offset = 0.05;
  UrdfRobot before = read_urdf(folder.write("before.urdf", kArm), folder.path());
  UrdfRobot after =
      read_urdf(folder.write("after.urdf", with_offsets(kArm, {{}, {{"shoulder", offset}}}, "u")), folder.path());
  pose_links(before, {{"shoulder", 0.7 + offset}}, "test");
  pose_links(after, {{"shoulder", 0.7}}, "test");
  const auto pose_of_upper = [](const UrdfRobot& robot) {
    for (const Node& link : robot.links)
      if (link.name == "upper") return link.T_parent_node;
    return Pose::Identity();
  };
  EXPECT_LT((pose_of_upper(before).matrix() - pose_of_upper(after).matrix()).norm(), 1e-12);
  EXPECT_THAT(folder.read("after.urdf"), HasSubstr("an arm")) << "the rest is kept";
}

TEST(UrdfOffsets, SetsAMountThatIsThere) {
  std::mt19937 random(5);
  const Pose T = random_pose(random);
  const std::string urdf = with_offsets(kArm, {{{"upper", "camera", T}}, {}}, "u");
  EXPECT_LT((read_mount(urdf, "camera", "u").T_parent_child.matrix() - T.matrix()).norm(), 1e-14);
  EXPECT_EQ(urdf.find("camera_mount"), std::string::npos);
}

TEST(UrdfOffsets, SaysWhatIsWrong) {
  EXPECT_THAT(refusal("words", {}), HasSubstr("arm.urdf"));
  EXPECT_THAT(refusal("<urdf/>", {}), HasSubstr("no <robot>"));
  EXPECT_THAT(refusal(kArm, {{}, {{"sholder", 0.1}}}), HasSubstr("did you mean 'shoulder'"));
  EXPECT_THAT(refusal(kArm, {{}, {{"mount", 0.1}}}), HasSubstr("fixed"));
  EXPECT_THAT(refusal(kArm, {{{"base", "camera", Pose::Identity()}}, {}}), HasSubstr("'upper'"));
  EXPECT_THAT(refusal(kArm, {{{"base", "upper", Pose::Identity()}}, {}}), HasSubstr("moves"));
  EXPECT_THAT(refusal(kArm, {{{"bse", "new", Pose::Identity()}}, {}}), HasSubstr("did you mean 'base'"));
}

}  // namespace
}  // namespace foresight::urdf_offsets_test
