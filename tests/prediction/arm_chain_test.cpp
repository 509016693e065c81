#include "prediction/arm_chain.hpp"

#include <algorithm>
#include <map>

#include "tests/prediction/sample_arms.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/palletiser.hpp"

namespace foresight::arm_chain_test {
namespace {

// T_root_tip by the URDF's own frames.
Pose posed_tip(UrdfRobot& robot, const std::string& tip, const ArmChain& arm, const JointVector& q) {
  std::map<std::string, double> positions;
  for (std::size_t j = 0; j < arm.size(); ++j) positions[arm.joints()[j].name] = q[static_cast<Eigen::Index>(j)];
  pose_links(robot, positions, "test");
  Pose T = Pose::Identity();
  for (auto link = std::ranges::find(robot.links, tip, &Node::name); link->parent >= 0;
       link = robot.links.begin() + link->parent)
    T = link->T_parent_node * T;
  return T;
}

void expect_derivative(const ArmChain& arm, const JointVector& q) {
  TipChange change;
  EXPECT_EQ(arm.tip_pose(q, change).matrix(), arm.tip_pose(q).matrix());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    constexpr double kStep = 1e-6;
    JointVector less = q, more = q;
    less[i] -= kStep, more[i] += kStep;
    const Vector6 slope = pose_difference(arm.tip_pose(less), arm.tip_pose(more)) / (2 * kStep);
    EXPECT_LT((slope - change[static_cast<std::size_t>(i)]).norm(), 1e-9) << i;
  }
}

std::vector<std::string> names_of(const ArmChain& arm) {
  std::vector<std::string> out;
  for (const ArmJoint& joint : arm.joints()) out.push_back(joint.name);
  return out;
}

TEST(ArmChain, ItsTipIsWhereTheFramesOfTheUrdfPutIt) {
  const auto file = source_folder() / "configs/arm.urdf";
  UrdfRobot robot = read_urdf(file, file.parent_path());
  const ArmChain arm = read_arm_chain(file, "arm_7");
  ASSERT_EQ(arm.size(), 7u);
  std::mt19937_64 random(1);
  for (int i = 0; i < 100; ++i) {
    const JointVector q = any_joints(arm, random);
    EXPECT_LT(pose_difference(arm.tip_pose(q), posed_tip(robot, "arm_7", arm, q)).norm(), 1e-14);
  }
}

TEST(ArmChain, JointsThatFollowAreInIt) {
  const TempFolder folder;
  std::mt19937_64 random(3);
  for (const Linkage linkage :
       {Linkage::forearm_by_rods, Linkage::at_the_wrist, Linkage::by_lever, Linkage::in_two_halves}) {
    const auto file = folder.write("r.urdf", palletiser_urdf(linkage));
    UrdfRobot robot = read_urdf(file, folder.path());
    const ArmChain arm = read_arm_chain(file, "hand");
    const bool lever = linkage == Linkage::by_lever;
    EXPECT_EQ(names_of(arm), lever ? std::vector<std::string>({"base_yaw", "shoulder", "wrist_roll", "rear_lever"})
                                   : std::vector<std::string>({"base_yaw", "shoulder", "elbow", "wrist_roll"}));
    EXPECT_EQ(arm.lines().size(), 6u);
    for (int i = 0; i < 50; ++i) {
      const JointVector q = any_joints(arm, random);
      const Pose T = arm.tip_pose(q);
      EXPECT_LT(pose_difference(T, posed_tip(robot, "hand", arm, q)).norm(), 1e-14);
      EXPECT_LE((T.translation() - arm.lines().front().point).norm(), arm.reach());
      expect_derivative(arm, q);
      if (linkage == Linkage::in_two_halves) continue;
      EXPECT_NEAR(T.linear()(2, 2), -1, 1e-14) << "level";
    }
  }
}

TEST(ArmChain, WhatFollowsAJointLimitsIt) {
  const TempFolder folder;
  const auto chain = [&](Linkage linkage) {
    return read_arm_chain(folder.write("r.urdf", palletiser_urdf(linkage)), "hand");
  };
  const ArmChain rods = chain(Linkage::forearm_by_rods);
  EXPECT_EQ(rods.joints()[1].lower, -0.6);
  EXPECT_EQ(rods.joints()[1].upper, 1.2) << "the rods go to -1.3";
  EXPECT_EQ(rods.joints()[1].velocity, 1.5);
  EXPECT_EQ(rods.joints()[2].velocity, 0.8) << "that of the rods at the wrist";
  const ArmChain lever = chain(Linkage::by_lever);
  EXPECT_EQ(lever.joints()[3].velocity, 0.8);
  EXPECT_FALSE(lever.joints()[3].carries_tip);
  EXPECT_NEAR(chain(Linkage::in_two_halves).joints()[2].velocity, 0.9 / 0.7, 1e-12);
}

TEST(ArmChain, AFollowerMayStandBeforeItsLeaderOrSlide) {
  const TempFolder folder;
  const std::string limit = "<limit lower='-1' upper='1' effort='1' velocity='1'/>";
  const std::string urdf =
      "<robot name='r'><link name='a'/><link name='b'/><link name='c'/><link name='d'/><joint name='follower' "
      "type='prismatic'><parent link='a'/><child link='b'/><axis xyz='1 0 0'/>" +
      limit + "<mimic joint='leader' multiplier='0.3' offset='0.1'/></joint>" +
      "<joint name='first' type='revolute'><parent link='b'/><child link='c'/><origin xyz='0 0 1'/><axis xyz='0 1 "
      "0'/>" +
      limit +
      "</joint><joint name='leader' type='revolute'><parent link='c'/><child link='d'/><origin xyz='1 0 0'/><axis "
      "xyz='0 0 1'/>" +
      limit + "</joint></robot>";
  const auto file = folder.write("r.urdf", urdf);
  UrdfRobot robot = read_urdf(file, folder.path());
  const ArmChain arm = read_arm_chain(file, "d");
  EXPECT_EQ(names_of(arm), std::vector<std::string>({"first", "leader"}));
  std::mt19937_64 random(4);
  for (int i = 0; i < 20; ++i) {
    const JointVector q = any_joints(arm, random);
    EXPECT_LT(pose_difference(arm.tip_pose(q), posed_tip(robot, "d", arm, q)).norm(), 1e-14);
    expect_derivative(arm, q);
  }
}

TEST(ArmChain, ItsChangeIsTheDerivativeOfItsTip) {
  std::mt19937_64 random(2);
  std::vector<ArmJoint> joints(3);
  for (ArmJoint& joint : joints) {
    joint = {"j", false, any_direction(random), any_direction(random), -1, 1, 1, true};
    joint.slides = &joint == &joints[1];
  }
  const ArmChain arm(joints, Pose(Eigen::Translation3d(0.1, 0.2, 0.3)), "arm");
  expect_derivative(arm, any_joints(arm, random));
}

TEST(ArmChain, PosesBetweenGoStraightAndEvenly) {
  Pose from = Pose::Identity(), to = Pose(Eigen::Translation3d(2, 0, -4));
  to.linear() = Eigen::AngleAxisd(3.0, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  EXPECT_LT(pose_difference(pose_between(from, to, 1), to).norm(), 1e-14);
  const Vector6 whole = pose_difference(from, to), part = pose_difference(from, pose_between(from, to, 0.25));
  EXPECT_LT((part - 0.25 * whole).norm(), 1e-14);
  EXPECT_EQ(pose_between(from, from, 0.5).matrix(), from.matrix());
}

std::string arm_urdf(const std::string& limit, const std::string& extra = "") {
  return "<robot name='r'><link name='a'/><link name='hand'><visual><geometry><mesh filename='package://no/where.stl'/>"
         "</geometry></visual></link><joint name='turn' type='revolute'><parent link='a'/><child link='hand'/>"
         "<axis xyz='0 0 1'/>" +
         limit + "</joint>" + extra + "</robot>";
}

TEST(ArmChain, AUrdfWithoutItsMeshesIsEnough) {
  const TempFolder folder;
  const auto file = folder.write("r.urdf", arm_urdf("<limit lower='-1' upper='2' effort='1' velocity='0.5'/>"));
  const ArmChain arm = read_arm_chain(file, "hand");
  EXPECT_EQ(arm.size(), 1u);
  EXPECT_EQ(arm.joints()[0].velocity, 0.5);
  EXPECT_TRUE(arm.joints()[0].velocity_known);
  EXPECT_THAT(input_error([&] { read_urdf(file, folder.path()); }), testing::HasSubstr("where.stl"));
}

TEST(ArmChain, WhatIsWrongWithAUrdfIsSaid) {
  const TempFolder folder;
  const std::string good = "<limit lower='-1' upper='1' effort='1' velocity='1'/>";
  const auto fault = [&](const std::string& urdf, const std::string& tip, const std::string& base = "") {
    const auto file = folder.write("r.urdf", urdf);
    return input_error([&] { read_arm_chain(file, tip, base); });
  };
  EXPECT_THAT(fault(arm_urdf("<limit lower='0' upper='0' effort='1' velocity='1'/>"), "hand"),
              says("joint 'turn'", "no way to move", "fixed joint"));
  EXPECT_THAT(fault(arm_urdf("<limit lower='1' upper='-1' effort='1' velocity='1'/>"), "hand"),
              says("joint 'turn'", "exceeds", "swap"));
  EXPECT_NE(fault(arm_urdf("<limit lower='nan' upper='1' effort='1' velocity='1'/>"), "hand"), "no error");
  EXPECT_THAT(fault(arm_urdf(good), "hnd"), says("r.urdf", "no link 'hnd'", "did you mean 'hand'"));
  EXPECT_THAT(fault(arm_urdf(good), "a"), says("r.urdf", "no moving joint", "choose a tip"));
  EXPECT_THAT(fault(arm_urdf(good), "a", "hand"), says("r.urdf", "does not hang below", "name a base"));
  const std::string second = "<joint name='again' type='fixed'><parent link='a'/><child link='hand'/></joint>";
  EXPECT_NE(fault(arm_urdf(good, second), "hand"), "no error");
  const std::string loop = "<joint name='back' type='fixed'><parent link='hand'/><child link='a'/></joint>";
  EXPECT_NE(fault(arm_urdf(good, loop), "hand"), "no error");
  EXPECT_NE(fault("", "hand"), "no error");
  const auto follower = [&](const std::string& mimic) {
    return "<link name='finger'/><joint name='f' type='revolute'><parent link='hand'/><child link='finger'/>" + good +
           "<mimic joint='turn' " + mimic + "/></joint>";
  };
  for (const char* type : {"floating", "planar"}) {
    const std::string under = std::string("<link name='world'/><joint name='drift' type='") + type +
                              "'><parent link='world'/><child link='a'/></joint>";
    EXPECT_THAT(fault(arm_urdf(good, under), "hand"), says("joint 'drift'", "floating or planar", "base below"));
    EXPECT_EQ(fault(arm_urdf(good, under), "hand", "a"), "no error");
  }
  EXPECT_EQ(fault(arm_urdf(good, follower("multiplier='0.5'")), "finger"), "no error");
  EXPECT_THAT(fault(arm_urdf(good, follower("offset='3'")), "finger"),
              says("joint 'turn'", "follow it leave it no way to move", "<mimic>"));
  EXPECT_EQ(fault(arm_urdf(good, follower("")), "finger", "hand"), "no error") << "its leader is before the base";
}

}  // namespace
}  // namespace foresight::arm_chain_test
