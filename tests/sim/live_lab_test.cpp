#include "sim/live_lab.hpp"

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "scene/primitives.hpp"
#include "sim/motion.hpp"

namespace foresight::sim::live_lab_test {
namespace {

LiveLab live(const HiddenDeviations& hidden = {}) {
  return LiveLab({0.02, 1, hidden});
}

TEST(PanTiltHead, TurnsLeftAndLooksDown) {
  const Pose ahead = T_world_head_left({});
  EXPECT_TRUE(ahead.linear().col(2).isApprox(Eigen::Vector3d::UnitX(), 1e-12));   // forward
  EXPECT_TRUE(ahead.linear().col(1).isApprox(-Eigen::Vector3d::UnitZ(), 1e-12));  // down
  EXPECT_GT(T_world_head_left({0.3, 0}).linear().col(2).y(), 0.2);
  EXPECT_LT(T_world_head_left({0, 0.3}).linear().col(2).z(), -0.2);
  EXPECT_NEAR(ahead.linear().determinant(), 1, 1e-12);
  const Pose right = ahead * T_head_left_right();
  EXPECT_TRUE((right.translation() - ahead.translation()).isApprox(Eigen::Vector3d(0, -0.065, 0), 1e-12));
  // Pan turns the pair about the axis in its middle.
  const auto middle = [](const PanTilt& shafts) -> Eigen::Vector3d {
    const Pose left = T_world_head_left(shafts);
    return 0.5 * (left.translation() + (left * T_head_left_right()).translation());
  };
  EXPECT_NEAR((middle({1, 0}) - T_world_head_foot().translation()).head<2>().norm(), 0.03, 1e-12);
}

TEST(LiveLab, PartsStandWhereTheShaftsStand) {
  const LiveLab world = live();
  const auto shafts = [](std::string_view joint) -> std::optional<double> {
    if (joint == "elbow") return 1.1;
    if (joint == "finger") return 0.03;
    return shafts_at_rest(joint);
  };
  ArmPosition arm = arm_position_at(0);
  arm.joints[3] = 1.1;
  arm.opening = 0.03;
  const auto links = arm_links_at(arm);
  const LabState state = world.true_state(shafts, 0);
  for (std::size_t i = 1; i < links.size(); ++i)
    EXPECT_TRUE(state[static_cast<std::size_t>(world.lab().arm) + i].isApprox(links[i], 1e-12)) << i;
  EXPECT_TRUE(world.T_world_left(shafts).isApprox(LiveLab::T_world_left_modelled(shafts), 0));
}

TEST(LiveLab, TheBallRollsWithoutSlip) {
  const double dt = 1e-4, radius = kBallRadius;
  for (double t : {0.1, 1.3, 5.0}) {
    const Pose a = LiveLab::T_world_ball(t), b = LiveLab::T_world_ball(t + dt);
    EXPECT_NEAR(a.translation().z(), 0.002 + radius, 1e-9);
    // The point that touches the mat does not move.
    const Eigen::Vector3d contact = a.inverse() * Eigen::Vector3d(a.translation() - radius * Eigen::Vector3d::UnitZ());
    EXPECT_LT((b * contact - a * contact).norm() / dt, 1e-3);
    EXPECT_GT((b.translation() - a.translation()).norm() / dt, 1e-2);
  }
}

TEST(LiveLab, OnlyTheLiveLabHasABall) {
  const Lab plain = make_lab(0.02, 1);
  EXPECT_THROW(plain.find(kBall), std::out_of_range);
  const LiveLab world = live();
  ASSERT_EQ(world.lab().parts.size(), plain.parts.size() + 1);
  for (std::size_t k = 0; k < plain.parts.size(); ++k) EXPECT_EQ(world.lab().parts[k].name, plain.parts[k].name);
}

/// A foot and what turns on it.
RobotScene turntable(const SceneModel* around = nullptr) {
  UrdfRobot robot;
  robot.name = "turner";
  robot.links = {{"foot", make_box({0.3, 0.3, 0.1}), -1, Pose::Identity()},
                 {"plate", make_cylinder(0.1, 0.05), 0, Pose::Identity()}};
  UrdfJoint turn;
  turn.name = "turn";
  turn.kind = UrdfJoint::Kind::rotating;
  turn.child = 1;
  turn.T_parent_joint.translation().z() = 0.1;
  turn.axis = Eigen::Vector3d::UnitZ();
  turn.lower = -2;
  turn.upper = 2;
  robot.joints = {turn};
  Pose T_world_robot = Pose::Identity();
  T_world_robot.translation() = Eigen::Vector3d(0.1, 0, 0.05);
  return {around, robot, T_world_robot};
}

TEST(LiveLab, ARigsRobotStandsInPlaceOfTheArm) {
  LiveLab::Options options{.texel = 0.02};
  options.things = std::make_shared<const RobotScene>(turntable());
  const LiveLab world(options);
  EXPECT_THROW(world.lab().find("arm_1"), std::out_of_range);
  const auto plate = static_cast<std::size_t>(world.lab().find("plate"));
  EXPECT_TRUE(world.lab().parts[plate].moves);
  EXPECT_FALSE(world.lab().parts[static_cast<std::size_t>(world.lab().find("foot"))].moves);
  const auto turned = [](std::string_view joint) -> std::optional<double> {
    return joint == "turn" ? std::optional(0.5) : std::nullopt;
  };
  for (const LabState& state : {world.true_state(turned, 1), world.modelled_state(turned)}) {
    EXPECT_TRUE(state[plate].translation().isApprox(Eigen::Vector3d(0.1, 0, 0.15), 1e-12));
    EXPECT_NEAR(Eigen::AngleAxisd(state[plate].linear()).angle(), 0.5, 1e-12);
  }
  EXPECT_FALSE(world.true_state(turned, 1)[static_cast<std::size_t>(world.lab().find(kBall))].isApprox(
      world.true_state(turned, 2)[static_cast<std::size_t>(world.lab().find(kBall))]));
  const Mesh& as_given = options.things->nodes()[1].mesh;
  EXPECT_EQ(mesh_of(world.lab().parts[plate]).triangles.size(), as_given.triangles.size());
}

TEST(LiveLab, ASceneStandsInPlaceOfTheFurniture) {
  const SceneModel around({{"crate", make_box({0.2, 0.2, 0.2})}});
  LiveLab::Options options{.texel = 0.02};
  options.things = std::make_shared<const RobotScene>(turntable(&around));
  options.furniture = false;
  const LiveLab world(options);
  ASSERT_EQ(world.lab().parts.size(), 3u);
  EXPECT_EQ(world.lab().parts[0].name, "crate");
  options.hidden.object_m = 0.01;
  EXPECT_THROW(LiveLab{options}, InputError) << "none of the lab's things can be displaced";
  options.hidden = {};
  options.furniture = true;
  const SceneModel mug({{"mug", make_box({0.2, 0.2, 0.2})}});
  options.things = std::make_shared<const RobotScene>(turntable(&mug));
  EXPECT_THROW(LiveLab{options}, InputError) << "two things are called mug";
}

TEST(LabArm, IsToldFromOthers) {
  UrdfRobot robot;
  robot.links = {{kArmStand, {}}};
  for (const ArmJoint& joint : arm_joints()) {
    robot.links.push_back({joint.child, {}, joint.parent});
    UrdfJoint copy;
    copy.name = joint.name;
    copy.child = static_cast<int>(robot.links.size()) - 1;
    copy.T_parent_joint.translation() = joint.xyz;
    copy.axis = joint.axis;
    robot.joints.push_back(copy);
  }
  EXPECT_TRUE(is_lab_arm(robot, T_world_stand()));
  EXPECT_FALSE(is_lab_arm(robot, Pose::Identity()));
  UrdfRobot longer = robot;
  longer.joints[3].T_parent_joint.translation().z() += 0.01;
  EXPECT_FALSE(is_lab_arm(longer, T_world_stand()));
  UrdfRobot other = robot;
  other.joints[3].name = "knee";
  EXPECT_FALSE(is_lab_arm(other, T_world_stand()));
}

TEST(LiveLab, DeviationsAreHiddenFromTheModelAndTheSameEachTime) {
  const HiddenDeviations hidden{3, 0.02, 0.1, 0.01};
  const LiveLab world = live(hidden), again = live(hidden), other = live({4, 0.02, 0.1, 0.01});
  ASSERT_GE(world.displaced(), 0);
  const LabState truth = world.true_state(shafts_at_rest, 1), model = world.modelled_state(shafts_at_rest);
  const auto k = static_cast<std::size_t>(world.displaced());
  EXPECT_NEAR((truth[k].translation() - model[k].translation()).norm(), 0.02, 1e-9);
  const auto hand = static_cast<std::size_t>(world.lab().find("arm_7"));
  const double off = (truth[hand].translation() - model[hand].translation()).norm();
  EXPECT_GT(off, 1e-4);
  EXPECT_LT(off, 0.1);
  EXPECT_FALSE(world.T_world_left(shafts_at_rest).isApprox(LiveLab::T_world_left_modelled(shafts_at_rest), 1e-6));
  const LabState same = again.true_state(shafts_at_rest, 1), different = other.true_state(shafts_at_rest, 1);
  for (std::size_t i = 0; i < truth.size(); ++i) EXPECT_EQ(truth[i].matrix(), same[i].matrix());
  EXPECT_NE(truth[hand].matrix(), different[hand].matrix());
  EXPECT_THROW(live({1, -0.1, 0, 0}), InputError);
}

}  // namespace
}  // namespace foresight::sim::live_lab_test
