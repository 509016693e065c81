#include "motion/robot_shape.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <random>

#include "common/error.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::robot_shape_test {
namespace {

TEST(Capsules, DistancesAreThoseOfTheirSurfaces) {
  const Capsule x{{0, 0, 0}, {1, 0, 0}, 0.1};
  EXPECT_NEAR(distance(x, Capsule{{0.5, 0.5, 0}, {0.5, 1, 0}, 0.1}), 0.3, 1e-12);
  EXPECT_NEAR(distance(x, Capsule{{0.5, -1, 0.4}, {0.5, 1, 0.4}, 0.1}), 0.2, 1e-12) << "crossing";
  EXPECT_NEAR(distance(x, Capsule{{0, 1, 0}, {1, 1, 0}, 0.2}), 0.7, 1e-12) << "parallel";
  EXPECT_NEAR(distance(x, Capsule{{2, 0, 0}, {2, 0, 0}, 0.5}), 0.4, 1e-12) << "a sphere";
  EXPECT_NEAR(distance(x, Capsule{{0.2, 0, 0}, {0.3, 0, 0}, 0.1}), -0.2, 1e-12) << "overlapping";
  const Eigen::AlignedBox3d box(Eigen::Vector3d(-5, -5, -2), Eigen::Vector3d(5, 5, -1));
  const double least = distance(x, box);
  EXPECT_LE(least, 0.9);
  EXPECT_GT(least, 0.85);
}

/// Three rods of 0.4 m that turn about y, one after the other, stretched upwards at 0; and a fourth.
UrdfRobot rods(const std::filesystem::path& folder) {
  std::string text = "<robot name='rods'><link name='base'/>";
  std::string parent = "base";
  for (int i = 1; i <= 4; ++i) {
    const std::string name = "rod_" + std::to_string(i);
    text += "<link name='" + name +
            "'><visual><origin xyz='0 0 0.2'/><geometry><box size='0.04 0.04 0.4'/></geometry></visual></link>";
    text += "<joint name='turn_" + std::to_string(i) + "' type='revolute'><parent link='" + parent +
            "'/><child link='" + name + "'/><origin xyz='0 0 " + (i == 1 ? "0" : "0.4") +
            "'/><axis xyz='0 1 0'/><limit lower='-3' upper='3' effort='1' velocity='1'/></joint>";
    parent = name;
  }
  const auto file = folder / "rods.urdf";
  std::ofstream(file) << text << "</robot>";
  return read_urdf(file, folder);
}

class RobotShapeTest : public testing::Test {
 protected:
  const char* obstructed(std::vector<double> positions) {
    shape_.surround(surroundings_);
    return shape_.obstructed(positions);
  }
  TempFolder folder_;
  RobotShape shape_{rods(folder_.path()), {"turn_1", "turn_2", "turn_3", "turn_4"}, Pose::Identity(), "rig.yaml"};
  Surroundings surroundings_;
};

TEST_F(RobotShapeTest, StandsFreeWithoutSurroundings) {
  EXPECT_EQ(obstructed({0, 0, 0, 0}), nullptr);
  EXPECT_EQ(obstructed({1, 0.5, 0.5, 0.5}), nullptr);
}

TEST_F(RobotShapeTest, NamesTheLinkThatLeavesTheWorkspace) {
  surroundings_.workspace = {Eigen::Vector3d(-1, -1, -0.2), Eigen::Vector3d(1, 1, 1.4)};
  EXPECT_STREQ(obstructed({0, 0, 0, 0}), "link 'rod_4' leaves the workspace");
  EXPECT_EQ(obstructed({0, 0, 0.8, 0.8}), nullptr);
}

TEST_F(RobotShapeTest, NamesTheLinkThatTouchesTheTable) {
  surroundings_.obstacles = {{"table", {Eigen::Vector3d(-3, -3, -1), Eigen::Vector3d(3, 3, -0.125)}}};
  EXPECT_EQ(obstructed({1.5, 0, 0, 0}), nullptr);
  EXPECT_STREQ(obstructed({1.7, 0, 0, 0}), "link 'rod_2' comes too close to obstacle 'table'");
}

TEST_F(RobotShapeTest, NamesTheLinksThatMeet) {
  // Folded to a closed triangle and on: the fourth rod meets the first.
  EXPECT_STREQ(obstructed({0, 2.0944, 2.0944, 2.0944}), "link 'rod_4' comes too close to link 'rod_1'");
}

TEST_F(RobotShapeTest, WhatIsTooCloseHasTheLeastMargin) {
  surroundings_.workspace = {Eigen::Vector3d(-1.2, -1, -0.5), Eigen::Vector3d(1.2, 1, 1.5)};
  surroundings_.obstacles = {{"table", {Eigen::Vector3d(0.3, -3, -1), Eigen::Vector3d(3, 3, -0.125)}},
                             {"post", {Eigen::Vector3d(-0.6, -0.1, -1), Eigen::Vector3d(-0.5, 0.1, 1)}}};
  shape_.surround(surroundings_);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> turn(-2.5, 2.5);
  std::vector<double> margins(shape_.couples());
  std::map<std::string, int> seen;
  for (int i = 0; i < 2000; ++i) {
    const std::vector<double> positions{turn(random), turn(random), turn(random), turn(random)};
    shape_.margins(positions, margins);
    const auto least = std::ranges::min_element(margins);
    const std::optional<std::size_t> found = shape_.too_close(positions);
    ASSERT_EQ(found.has_value(), *least < 0);
    if (found) {
      ASSERT_EQ(margins[*found], *least);
    }
    ++seen[found ? shape_.message(*found) : "clear"];
  }
  EXPECT_GT(seen["clear"], 100);
  EXPECT_GT(seen["link 'rod_4' comes too close to link 'rod_1'"], 10);
  EXPECT_GT(seen["link 'rod_3' comes too close to obstacle 'post'"], 10);
}

// A hand on a flange is as near to the forearm as the link that it is fixed to.
TEST_F(RobotShapeTest, RigidJointsDoNotSetLinksApart) {
  const auto couples = [&](const std::string& kind) {
    const auto rod = [](const std::string& name) {
      return "<link name='" + name + "'><visual><geometry><sphere radius='0.1'/></geometry></visual></link>";
    };
    const auto joint = [](int i, const std::string& type) {
      const std::string n = std::to_string(i);
      return "<joint name='j" + n + "' type='" + type + "'><parent link='l" + std::to_string(i - 1) +
             "'/><child link='l" + n + "'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>";
    };
    const auto file =
        folder_.write("hand.urdf", "<robot name='hand'>" + rod("l0") + rod("l1") + rod("l2") + rod("l3") +
                                       joint(1, "revolute") + joint(2, "revolute") + joint(3, kind) + "</robot>");
    std::vector<std::string> moving{"j1", "j2"};
    if (kind != "fixed") moving.emplace_back("j3");
    return RobotShape(read_urdf(file), moving, Pose::Identity(), "rig.yaml").couples();
  };
  EXPECT_EQ(couples("revolute"), 1u) << "the first and the last";
  EXPECT_EQ(couples("fixed"), 0u);
}

TEST_F(RobotShapeTest, SaysWhichLinksItGuards) {
  const UrdfRobot robot = rods(folder_.path());
  EXPECT_EQ(to_text(guarded_links(robot)),
            "4 of 5 links guarded by their visual shapes; the URDF has no collision shapes; without a shape, as frames "
            "are: base");
  const auto file = folder_.path() / "two.urdf";
  std::ofstream(file) << R"(<robot name='two'>
<link name='base'><visual><geometry><box size='1 1 1'/></geometry></visual></link>
<link name='arm'><visual><geometry><box size='0.1 0.1 1'/></geometry></visual>
<collision><geometry><box size='0.1 0.1 3'/></geometry></collision></link>
<joint name='turn' type='continuous'><parent link='base'/><child link='arm'/><axis xyz='0 1 0'/></joint></robot>)";
  UrdfRobot two = read_urdf(file, folder_.path(), UrdfShapes::all);
  EXPECT_EQ(to_text(guarded_links(two)), "2 of 2 links guarded (1 by collision shapes, 1 by visual ones)");
  RobotShape shape(two, {"turn"}, Pose::Identity(), "rig.yaml");
  shape.surround({.workspace = {Eigen::Vector3d(-5, -5, -1), Eigen::Vector3d(5, 5, 1)}, .obstacles = {}});
  EXPECT_NE(shape.obstructed(std::vector{0.0}), nullptr) << "the collision shape is the longer one";
}

TEST_F(RobotShapeTest, RefusesAnUnknownJoint) {
  EXPECT_THROW(RobotShape(rods(folder_.path()), {"turn_9"}, Pose::Identity(), "rig.yaml"), InputError);
}

}  // namespace
}  // namespace foresight::robot_shape_test
