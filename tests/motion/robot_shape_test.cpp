#include "motion/guarded_motion.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <numbers>
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
  double margin(const std::string& couple, std::vector<double> positions) {
    std::vector<double> margins(shape_.couples());
    shape_.margins(positions, margins);
    return margins.at(couple_named(couple));
  }
  std::size_t couple_named(const std::string& couple) const {
    for (std::size_t i = 0; i < shape_.couples(); ++i)
      if (shape_.message(i) == couple) return i;
    ADD_FAILURE() << "not compared: " << couple;
    return shape_.couples();
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

// With two joints between them: no capsule could tell, as its cap reaches over the joint.
TEST_F(RobotShapeTest, LinksFoldOntoTheOneBeforeTheLast) {
  EXPECT_LT(margin("link 'rod_3' comes too close to link 'rod_1'", {0, 2.2, 2.2, 0}), 0);
  EXPECT_LT(margin("link 'rod_4' comes too close to link 'rod_2'", {0, 0, -2.2, -2.2}), 0);
  EXPECT_EQ(obstructed({0, 1.5, 1.5, 0}), nullptr);
  EXPECT_EQ(obstructed({0, 2.2, -2.2, 0}), nullptr) << "the other way";
  EXPECT_TRUE(shape_.nested().empty());
}

// Positions between those of the table, against the meshes themselves.
TEST_F(RobotShapeTest, NearLinksAreKeptApartAsTheirMeshesAre) {
  shape_.surround(surroundings_);
  const UrdfRobot robot = rods(folder_.path());
  const TriangleTree rod(robot.links[1].mesh);
  PosedLinks posed(robot, {"turn_1", "turn_2", "turn_3", "turn_4"}, Pose::Identity(), "rig.yaml");
  std::mt19937 random(3);
  std::uniform_real_distribution<double> turn(-3, 3);
  int refused = 0, needlessly = 0;
  for (int i = 0; i < 20'000; ++i) {
    const std::vector<double> positions{0.3, turn(random), turn(random), 0.1};
    const double here = margin("link 'rod_3' comes too close to link 'rod_1'", positions);
    posed.pose(positions);
    const double apart = rod.nearest(rod, posed.T_world_link(1).inverse() * posed.T_world_link(3), 9).distance;
    if (here >= 0) {
      EXPECT_GT(apart, 0.0175) << positions[1] << " " << positions[2];
    }
    if (here >= 0 && i % 100 == 0) {
      std::vector<double> seen(shape_.couples());
      shape_.margins_by_meshes(positions, seen);
      EXPECT_NEAR(seen[couple_named("link 'rod_3' comes too close to link 'rod_1'")], std::max(0.0, apart - 0.02),
                  1e-9);
      EXPECT_LE(here, apart - 0.0175);
    }
    refused += here < 0 ? 1 : 0;
    needlessly += here < 0 && apart > 0.04 ? 1 : 0;
  }
  EXPECT_GT(refused, 1500);
  EXPECT_EQ(needlessly, 0);
}

TEST_F(RobotShapeTest, TablesAreMadeOnceForAllThatAskForTheSame) {
  const std::vector<std::string> joints{"turn_1", "turn_2", "turn_3", "turn_4"};
  const std::vector<bool> jaws(joints.size());
  const auto tables = [&](const UrdfRobot& robot, double clearance) {
    const PosedLinks posed(robot, joints, Pose::Identity(), "rig.yaml");
    return NearCouples::of({robot, joints, jaws, posed}, clearance);
  };
  UrdfRobot robot = rods(folder_.path());
  const auto first = tables(robot, 0.02);
  EXPECT_EQ(first, tables(rods(folder_.path()), 0.02));
  EXPECT_NE(first, tables(robot, 0.03));
  robot.joints[2].upper = 2;
  const auto narrower = tables(robot, 0.02);
  EXPECT_NE(first, narrower);
  robot.links[3].mesh.vertices[0].x() += 0.01F;
  EXPECT_NE(narrower, tables(robot, 0.02));
}

TEST_F(RobotShapeTest, OutOfAFoldThereIsAWay) {
  GateOptions options;
  options.joints.assign(4, {"turn", {-3, 3, 1, 4, 60}});
  GuardedMotion motion(options, &shape_);
  JointValues at{0, 2.4, 2.4, 0}, deeper{0, 2.4, 2.9, 0}, out{0, 2.4, 0, 0};
  const auto depth = [&] {
    return margin("link 'rod_3' comes too close to link 'rod_1'", {at[0], at[1], at[2], at[3]});
  };
  for (std::size_t i = 0; i < 4; ++i) motion.set(i, {at[i]});
  ASSERT_LT(depth(), -0.05) << "through each other";
  for (int cycle = 0; cycle < 200; ++cycle) EXPECT_TRUE(motion.go_towards(deeper, 1));
  EXPECT_EQ(motion[2].position, 2.4);
  double before = depth();
  for (int cycle = 0; cycle < 10'000 && std::abs(at[2]) > 1e-3; ++cycle) {
    motion.go_towards(out, 1);
    for (std::size_t i = 0; i < 4; ++i) at[i] = motion[i].position;
    ASSERT_TRUE(depth() >= 0 || depth() >= before - 1e-9) << at[2];
    before = depth();
  }
  EXPECT_NEAR(at[2], 0, 1e-3);
}

// Some joints brake four times as long as others, and targets come while they still move.
TEST_F(RobotShapeTest, WhateverTheRobotIsAskedItStaysClear) {
  GateOptions options;
  for (const double acceleration : {2.0, 8.0, 2.0, 8.0})
    options.joints.push_back({"turn", {-2.8, 2.8, 1, acceleration, 15 * acceleration}});
  options.surroundings.workspace = {Eigen::Vector3d(-2, -2, -1.2), Eigen::Vector3d(2, 2, 2)};
  options.surroundings.obstacles = {{"crate", {Eigen::Vector3d(0.5, -1, -0.5), Eigen::Vector3d(0.7, 1, 0.3)}}};
  GuardedMotion motion(options, &shape_);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> position(-2.8, 2.8);
  std::uniform_int_distribution<int> cycles(10, 400);
  std::vector<double> margins(shape_.couples());
  int blocked = 0;
  double least = 1;
  JointValues targets{}, at{};
  for (int cycle = 0, until = 0; cycle < 20'000; ++cycle) {
    if (cycle == until) {
      for (std::size_t i = 0; i < 4; ++i) targets[i] = position(random);
      until += cycles(random);
    }
    blocked += motion.go_towards(targets, 1) ? 1 : 0;
    for (std::size_t i = 0; i < 4; ++i) at[i] = motion[i].position;
    shape_.margins({at.data(), 4}, margins);
    least = std::min(least, *std::ranges::min_element(margins));
  }
  EXPECT_GT(least, -0.1e-3);
  EXPECT_GT(blocked, 1000) << "nothing is in its way";
  EXPECT_LT(blocked, 15'000) << "it hardly moves";
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
  EXPECT_GT(seen["link 'rod_3' comes too close to link 'rod_1'"], 10);
  EXPECT_GT(seen["link 'rod_3' comes too close to obstacle 'post'"], 10);
}

// A hand on a flange is as near to the forearm as the link that it is fixed to. And balls in each other stay so.
TEST_F(RobotShapeTest, RigidJointsDoNotSetLinksApart) {
  const auto shape = [&](const std::string& kind, bool jaws = false) {
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
    return RobotShape(read_urdf(file), moving, Pose::Identity(), "rig.yaml", std::vector<bool>(moving.size(), jaws));
  };
  EXPECT_EQ(shape("revolute").couples(), 1u) << "the first and the last";
  EXPECT_EQ(shape("revolute", true).couples(), 0u) << "jaws close on each other";
  EXPECT_EQ(shape("fixed").couples(), 0u);
  EXPECT_THAT(shape("fixed").nested(),
              testing::UnorderedElementsAre(testing::ElementsAre("l2", "l0"), testing::ElementsAre("l3", "l0")));
}

// A wrist that turns without end, with a paddle that passes the forearm once a turn.
TEST_F(RobotShapeTest, JointsWithoutEndAreGuardedInEveryTurn) {
  const auto file = folder_.write("wrist.urdf", R"(<robot name='wrist'>
<link name='forearm'><visual><origin xyz='0 0 -0.2'/><geometry><box size='0.06 0.06 0.4'/></geometry></visual></link>
<link name='wrist'><visual><geometry><box size='0.02 0.02 0.02'/></geometry></visual></link>
<link name='paddle'><visual><origin xyz='0 0 0.1'/><geometry><box size='0.02 0.1 0.1'/></geometry></visual></link>
<joint name='pitch' type='continuous'><parent link='forearm'/><child link='wrist'/><axis xyz='0 1 0'/></joint>
<joint name='roll' type='continuous'><parent link='wrist'/><child link='paddle'/><axis xyz='0 0 1'/></joint></robot>)");
  RobotShape shape(read_urdf(file), {"pitch", "roll"}, Pose::Identity(), "rig.yaml");
  for (const double turns : {0, 1, -3}) {
    const double whole = turns * 2 * std::numbers::pi;
    EXPECT_EQ(shape.obstructed(std::vector<double>{whole + 1, 0.5 - whole}), nullptr) << turns;
    EXPECT_STREQ(shape.obstructed(std::vector<double>{whole + std::numbers::pi, 2 - whole}),
                 "link 'paddle' comes too close to link 'forearm'")
        << turns;
  }
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
