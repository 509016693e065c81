#include "calibration/formats/urdf_offsets.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "common/error.hpp"
#include "scene/urdf_reader.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight {
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
}  // namespace foresight
