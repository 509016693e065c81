#include "prediction/contact/sliding_hand.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "common/error.hpp"
#include "scene/primitives.hpp"
#include "tests/contact/made_robot.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/palletiser.hpp"

namespace foresight::sliding_hand_test {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

constexpr double kPicture = 1.0 / 60;

double any(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

// A ball of 3 cm on three slides, 1 m/s each.
struct Gantry {
  explicit Gantry(const SceneModel* scene, std::vector<double> start = {0, 0, 0.2}, RobotShape* gate = nullptr)
      : robot(made_gantry(make_sphere(0.03))),
        kinematics(arm_chain(robot, "tool", "base", "test")),
        model(robot, gantry_joints(), scene, Pose::Identity(), "test"),
        hand(model, kinematics, gantry_joints(), start, Pose::Identity(), gate, "test") {}
  HandStep go(double x, double y, double z) {
    return hand.step(shifted(x, y, z), std::vector<double>(3, 0.0), {}, kPicture);
  }
  UrdfRobot robot;
  InverseKinematics kinematics;
  ContactModel model;
  SlidingHand hand;
};

struct LabArm {
  explicit LabArm(const SceneModel* scene, std::vector<double> start = {0, 0.9, 0, 0.9, 0, -0.3, 0, 0.02},
                  double velocity = 2)
      : robot(made_lab_arm(velocity)),
        kinematics(arm_chain(robot, "arm_7", "stand", "test")),
        model(robot, lab_arm_joints(), scene, Pose::Identity(), "test"),
        hand(model, kinematics, lab_arm_joints(), start, Pose::Identity(), nullptr, "test") {}
  UrdfRobot robot;
  InverseKinematics kinematics;
  ContactModel model;
  SlidingHand hand;
};

// Four drives: it cannot tilt its hand.
struct Palletiser {
  explicit Palletiser(const SceneModel* scene)
      : robot(read_urdf(folder.write("arm.urdf", palletiser_urdf(Linkage::by_lever)))),
        kinematics(arm_chain(robot, "hand", "foot", "test")),
        model(robot, joints(), scene, Pose::Identity(), "test"),
        hand(model, kinematics, joints(), start(), Pose::Identity(), nullptr, "test") {}
  std::vector<std::string> joints() const {
    std::vector<std::string> out;
    for (const ArmJoint& joint : kinematics.chain().joints()) out.push_back(joint.name);
    return out;
  }
  std::vector<double> start() const {
    const JointVector& q = kinematics.chain().middle();
    return {q.begin(), q.end()};
  }
  TempFolder folder;
  UrdfRobot robot;
  InverseKinematics kinematics;
  ContactModel model;
  SlidingHand hand;
};

SceneModel table() {
  return made_scene({{"table", make_box({2, 2, 0.02}), shifted(0, 0, -0.01)}});
}

double step_over_limit(const ArmChain& chain, std::span<const double> before, std::span<const double> after) {
  double most = 0;
  for (std::size_t i = 0; i < chain.size(); ++i)
    most = std::max(most, std::abs(after[i] - before[i]) / (chain.joints()[i].velocity * kPicture));
  return most;
}

TEST(SlidingHand, OfFewJointsGoesAlongASurfaceWithAHandThatItCannotTiltLike) {
  constexpr double kTop = 0.55, kHandBelow = 0.07;
  const SceneModel scene = made_scene({{"table", make_box({0.8, 2, 0.02}), shifted(0.9, 0, kTop - 0.01)}});
  Palletiser arm(&scene);
  const Pose begin = arm.kinematics.chain().tip_pose(arm.kinematics.chain().middle());
  Pose wanted = begin;
  wanted.translation() += Vector3d(-0.05, 0.1, -0.3);
  wanted.linear() =
      Eigen::AngleAxisd(0.3, Vector3d::UnitZ()) * Eigen::AngleAxisd(0.4, Vector3d::UnitX()) * begin.linear();
  HandStep step;
  for (int i = 1; i <= 180; ++i)
    step = arm.hand.step(pose_between(begin, wanted, std::min(1.0, i / 120.0)), arm.start(), {}, kPicture);
  const Pose& T = step.T_base_tip;
  EXPECT_EQ(step.ghost.reason, GhostReason::contact) << step.ghost.words;
  EXPECT_NEAR(T.translation().z(), kTop + kHandBelow, 0.005);
  EXPECT_LT((T.translation() - wanted.translation()).head<2>().norm(), 0.003) << "the place comes first";
  const Eigen::Matrix3d turned = T.linear() * begin.linear().transpose();
  EXPECT_NEAR(std::atan2(turned(1, 0), turned(0, 0)), 0.3, 0.1) << "and is turned about the vertical";
}

TEST(SlidingHand, InTheOpenItIsWhereTheHandIs) {
  const SceneModel scene = table();
  Gantry gantry(&scene);
  for (int i = 1; i <= 50; ++i) {
    const HandStep step = gantry.go(0.005 * i, -0.003 * i, 0.2);
    ASSERT_TRUE(step.valid);
    EXPECT_FALSE(step.ghost.shown);
    EXPECT_EQ(step.ghost.reason, GhostReason::none);
    EXPECT_LT((step.T_base_tip.translation() - Vector3d(0.005 * i, -0.003 * i, 0.2)).norm(), 1e-8);
  }
}

TEST(SlidingHand, StopsAtTheTableAndTheGhostSaysWhy) {
  const SceneModel scene = table();
  Gantry gantry(&scene);
  HandStep step;
  for (int i = 1; i <= 60; ++i) step = gantry.go(0.1, 0, 0.2 - 0.005 * i);
  EXPECT_NEAR(step.T_base_tip.translation().z(), 0.03 + kSkin, 1e-4);
  EXPECT_NEAR(step.T_base_tip.translation().x(), 0.1, 1e-3);
  EXPECT_TRUE(step.ghost.shown);
  EXPECT_EQ(step.ghost.reason, GhostReason::contact);
  EXPECT_EQ(step.ghost.words, "tool touches table");
  EXPECT_LT((step.ghost.out - Vector3d(0, 0, 1)).norm(), 1e-3);
  EXPECT_NEAR(step.ghost.depth, 0.131, 2e-3);
  ASSERT_FALSE(step.near.empty());
  EXPECT_NEAR(step.near[0].distance, kSkin, 1e-4);
}

TEST(SlidingHand, SlidesAlongWithTheRestOfTheMotion) {
  const SceneModel scene = table();
  Gantry gantry(&scene);
  for (int i = 1; i <= 40; ++i) gantry.go(0, 0, 0.2 - 0.006 * i);
  HandStep step;
  for (int i = 1; i <= 60; ++i) {
    step = gantry.go(0.006 * i, -0.004 * i, -0.05 - 0.001 * i);
    EXPECT_GT(step.near.at(0).distance, kLeastSkin);
    EXPECT_LT(step.T_base_tip.translation().z(), 0.03 + 2 * kSkin);
  }
  const Vector3d tool = step.T_base_tip.translation();
  EXPECT_GT(tool.x(), 0.99 * 0.36);  // of the way along the table
  EXPECT_LT(tool.y(), -0.99 * 0.24);
}

TEST(SlidingHand, ComesBackWithoutAJump) {
  const SceneModel scene = table();
  Gantry gantry(&scene);
  HandStep step;
  for (int i = 1; i <= 60; ++i) gantry.go(0, 0, 0.2 - 0.006 * i);
  std::vector<double> before(gantry.hand.positions().begin(), gantry.hand.positions().end());
  for (int i = 60; i >= 0; --i) {
    step = gantry.go(0, 0, 0.2 - 0.006 * i);
    EXPECT_LE(step_over_limit(gantry.kinematics.chain(), before, step.positions), 1.0);
    // It waits for the hand to come out again.
    if (0.2 - 0.006 * i < 0.03) {
      EXPECT_NEAR(step.T_base_tip.translation().z(), 0.031, 1e-3);
    }
    before = step.positions;
  }
  EXPECT_FALSE(step.ghost.shown);
  EXPECT_LT((step.T_base_tip.translation() - Vector3d(0, 0, 0.2)).norm(), 1e-8);
}

TEST(SlidingHand, AStillHandMovesNothingBitForBit) {
  const SceneModel scene = table();
  LabArm arm(&scene);
  const Pose at = arm.hand.step(Pose::Identity(), arm.hand.positions(), {}, 1e-9).T_base_tip;
  const std::vector<double> before(arm.hand.positions().begin(), arm.hand.positions().end());
  for (int i = 0; i < 20; ++i) {
    const HandStep step = arm.hand.step(at, arm.hand.positions(), {}, kPicture);
    ASSERT_TRUE(step.valid);
    ASSERT_EQ(step.positions, before);
    EXPECT_FALSE(step.ghost.shown);
  }
}

// A sheet without thickness that no arm gets round, hands that jump anywhere at any time, and arms of up to 20 rad/s.
TEST(SlidingHand, NothingGoesThroughAThinWallAtAnySpeed) {
  const double wall = 0.38;
  const SceneModel scene = made_scene({{"wall", made_sheet(6), shifted(wall, 0, 0)}});
  int pressed = 0, shown = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    std::mt19937_64 random(seed);
    LabArm arm(&scene, {any(random, -0.5, 0.5), -0.6, 0, 1.2, any(random, -1, 1), 0.5, 0, 0.02}, any(random, 1, 20));
    ASSERT_EQ(arm.model.pose(arm.hand.positions()), nullptr);
    ASSERT_TRUE(arm.model.touching().empty()) << seed;
    const double speed = any(random, 0.2, 20);  // m/s
    Pose hand = arm.hand.step(Pose::Identity(), arm.hand.positions(), {}, 1e-9).T_base_tip, target = hand;
    for (int i = 0; i < 16; ++i) {
      if (i % 6 == 0) {
        target.translation() = Vector3d(any(random, 0.2, 0.9), any(random, -0.4, 0.4), any(random, 1.0, 1.6));
        target.linear() =
            Eigen::AngleAxisd(any(random, -2, 2), Vector3d(0, 1, any(random, -1, 1)).normalized()).toRotationMatrix();
      }
      const double left = (target.translation() - hand.translation()).norm();
      hand = pose_between(hand, target, std::min(1.0, speed * kPicture / std::max(left, 1e-9)));
      const std::vector<double> before(arm.hand.positions().begin(), arm.hand.positions().end());
      const HandStep step = arm.hand.step(hand, arm.hand.positions(), {}, kPicture);
      ASSERT_TRUE(step.valid);
      ASSERT_LE(step_over_limit(arm.kinematics.chain(), before, step.positions), 1.0);
      ASSERT_LE(step.parts, 64);
      arm.model.pose(step.positions);
      for (std::size_t link = 0; link < arm.robot.links.size(); ++link)
        for (const auto& v : arm.robot.body(link).vertices)
          ASSERT_LT((arm.model.links().T_world_link(link) * v.cast<double>()).x(), wall) << seed << ' ' << i;
      ASSERT_TRUE(arm.model.touching().empty()) << seed << ' ' << i;
      pressed += step.ghost.reason == GhostReason::contact;
      shown += step.ghost.shown;
    }
  }
  EXPECT_GT(pressed, 500);
  EXPECT_GT(shown, 500);
}

TEST(SlidingHand, AnArmSlidesAlongAWallTooFarForIt) {
  const SceneModel scene = made_scene({{"wall", made_sheet(6), shifted(0.5, 0, 0)}});
  LabArm arm(&scene, {0, -0.3, 0, 1.4, 0, 0.5, 0, 0.02});
  const Pose start = arm.hand.step(Pose::Identity(), arm.hand.positions(), {}, 1e-9).T_base_tip;
  Pose hand = start;
  hand.translation().x() = 0.6;
  HandStep step;
  for (int i = 0; i < 90; ++i) step = arm.hand.step(hand, arm.hand.positions(), {}, kPicture);
  ASSERT_EQ(step.ghost.reason, GhostReason::contact);
  const double y = step.T_base_tip.translation().y(), z = step.T_base_tip.translation().z();
  for (int i = 1; i <= 120; ++i) {
    hand.translation().y() = start.translation().y() + 0.001 * i;
    hand.translation().z() = start.translation().z() - 0.0005 * i;
    step = arm.hand.step(hand, arm.hand.positions(), {}, kPicture);
    EXPECT_LT(step.near.at(0).distance, 2 * kSkin);
  }
  EXPECT_GT(step.T_base_tip.translation().y() - y, 0.85 * 0.12);
  EXPECT_LT(step.T_base_tip.translation().z() - z, -0.7 * 0.06);
}

TEST(SlidingHand, StopsWhereTheGateWouldStopTheRobot) {
  const SceneModel scene = table();
  const UrdfRobot robot = made_gantry(make_sphere(0.03));
  RobotShape gate(robot, gantry_joints(), Pose::Identity(), "test");
  gate.surround({{}, {{"table", {Vector3d(-1, -1, -0.02), Vector3d(1, 1, 0)}}}, 0.02});
  Gantry gantry(&scene, {0, 0, 0.2}, &gate);
  HandStep step;
  for (int i = 1; i <= 60; ++i) {
    step = gantry.go(0.002 * i, 0, 0.2 - 0.005 * i);
    ASSERT_EQ(gate.obstructed(step.positions), nullptr);
  }
  EXPECT_EQ(step.ghost.reason, GhostReason::gate);
  EXPECT_THAT(step.ghost.words, HasSubstr("comes too close to obstacle 'table'"));
  EXPECT_GT(step.T_base_tip.translation().z(), 0.05);
  EXPECT_LT(step.T_base_tip.translation().z(), 0.056);
  EXPECT_NEAR(step.T_base_tip.translation().x(), 0.12, 2e-3);  // and slides
}

TEST(SlidingHand, FingersCloseAsFarAsTheThing) {
  const SceneModel scene = made_scene({{"thing", make_box({0.04, 0.04, 0.04})}});
  LabArm arm(&scene, {0, 0.9, 0, 0.9, 0, -0.3, 0, 0.04});
  arm.model.pose(arm.hand.positions());
  const Pose T_palm = arm.model.links().T_world_link(7);
  const std::vector<Pose> nodes{T_palm * shifted(0, 0, 0.12)};
  const Pose at = arm.kinematics.chain().tip_pose(Eigen::Map<const Eigen::VectorXd>(arm.hand.positions().data(), 7));
  std::vector<double> others(8, 0.0);
  HandStep step;
  for (int i = 1; i <= 30; ++i) {
    others[7] = std::max(0.0, 0.04 - 0.0016 * i);
    step = arm.hand.step(at, others, nodes, kPicture);
    ASSERT_TRUE(step.valid);
  }
  // Each finger is 15 mm wide about 10 mm beside its joint.
  EXPECT_NEAR(step.positions[7], 0.02 + 0.0075 - 0.01 + kSkin, 2e-4);
  others[7] = 0.03;
  for (int i = 0; i < 5; ++i) step = arm.hand.step(at, others, nodes, kPicture);
  EXPECT_NEAR(step.positions[7], 0.03, 1e-9);
}

// Picked up from the table that it stands on, to the last bit, carried along it and set down again.
TEST(SlidingHand, WhatIsCarriedStopsTheArmAndComesOffItsTable) {
  const SceneModel scene = made_scene({{"table", make_box({2, 2, 0.02}), shifted(0, 0, -0.01)},
                                       {"thing", make_box({0.05, 0.05, 0.1}), shifted(0, 0, 0.05)}});
  Gantry gantry(&scene);
  HandStep step;
  for (int i = 1; i <= 40; ++i) step = gantry.go(0, 0, 0.2 - 0.002 * i);
  EXPECT_EQ(step.ghost.words, "tool touches thing");
  gantry.model.attach(1, 3, shifted(0, 0, 0.05 - step.T_base_tip.translation().z()));
  for (int i = 1; i <= 30; ++i) step = gantry.go(0.005 * i, 0, 0.14 + 0.002 * i);
  EXPECT_FALSE(step.ghost.shown);
  EXPECT_LT((step.T_base_tip.translation() - Vector3d(0.15, 0, 0.2)).norm(), 1e-8);
  for (int i = 1; i <= 60; ++i) step = gantry.go(0.15, 0, 0.2 - 0.003 * i);
  EXPECT_EQ(step.ghost.words, "thing touches table");
  EXPECT_NEAR(step.T_base_tip.translation().z(), 0.132, 3e-4);  // both skins
}

TEST(SlidingHand, WhatCameIntoTheArmIsLeftButNotEnteredDeeper) {
  const SceneModel scene = table();
  Gantry gantry(&scene);
  gantry.go(0, 0, 0.2);
  const std::vector<Pose> raised{shifted(0, 0, 0.165)};  // the table's top is 5 mm inside of the ball
  const auto go = [&](double x, double z) {
    return gantry.hand.step(shifted(x, 0, z), std::vector<double>(3, 0.0), raised, kPicture);
  };
  HandStep step;
  for (int i = 0; i < 20; ++i) step = go(0, 0.15);
  EXPECT_NEAR(step.T_base_tip.translation().z(), 0.2, 1e-4);
  EXPECT_EQ(step.ghost.reason, GhostReason::contact);
  ASSERT_FALSE(step.near.empty());
  EXPECT_EQ(step.near[0].distance, 0);
  for (int i = 0; i < 30; ++i) step = go(0.02, 0.26);
  EXPECT_LT((step.T_base_tip.translation() - Vector3d(0.02, 0, 0.26)).norm(), 1e-8);
  EXPECT_FALSE(step.ghost.shown);
}

// As what was grasped off a table: nearer than the arm itself would ever go, and not in it.
TEST(SlidingHand, WhatCameToAHairsBreadthOfTheArmIsLeft) {
  constexpr double kSlow = 0.25;  // s: a picture of a busy machine, in which joints go far
  const SceneModel scene = made_scene({{"box", make_box({0.2, 0.2, 0.02}), shifted(0, 0, -1)}});
  for (const double gap : {1e-7, 1e-5, 1.5e-4, 2.1e-4, 2.5e-4, 4e-4, 7e-4}) {
    LabArm arm(&scene, {0, 0.9, 0, 1.2, 0, 0.3, 0, 0.02});
    Pose box = shifted(0, 0, -1);
    const auto go = [&](const Pose& hand, double dt) {
      return arm.hand.step(hand, arm.hand.positions(), std::vector<Pose>{box}, dt);
    };
    const Pose start = go(Pose::Identity(), 1e-9).T_base_tip;
    box.translation() = start.translation() - Vector3d(0, 0, 0.5);
    const auto to_box = [&] {
      const HandStep step = go(start, 1e-9);
      const auto near =
          std::ranges::find(step.near, "box", [&](const Nearness& n) { return arm.model.other_name(n.couple); });
      return near == step.near.end() ? kContactReach : near->distance;
    };
    while (to_box() == kContactReach) box.translation().z() += 0.01;
    box.translation().z() += to_box() - gap;
    ASSERT_NEAR(to_box(), gap, 1e-8);
    HandStep step;
    for (int i = 1; i <= 10; ++i) step = go(shifted(0.006 * i, 0, 0.012 * i) * start, kSlow);
    const Vector3d gone = step.T_base_tip.translation() - start.translation();
    EXPECT_LT((gone - Vector3d(0.06, 0, 0.12)).norm(), 1e-6) << gap;
    for (int i = 1; i <= 20; ++i) go(shifted(0, 0, -0.5) * start, kSlow);
    EXPECT_GT(to_box(), kLeastSkin) << "and is not gone into";
    EXPECT_LT(to_box(), 2 * kSkin);
  }
}

TEST(SlidingHand, AStraightWayOfJointsEndsAtContact) {
  const SceneModel scene = table();
  Gantry gantry(&scene);
  HandStep step = gantry.hand.go_to(std::vector<double>{0.02, 0.01, 0.15}, {});
  EXPECT_EQ(step.positions, (std::vector<double>{0.02, 0.01, 0.15})) << "to the last bit";
  EXPECT_EQ(step.ghost.reason, GhostReason::none);
  step = gantry.hand.go_to(std::vector<double>{0.10, 0.01, -0.05}, {});
  ASSERT_TRUE(step.valid);
  EXPECT_NEAR(step.positions[2], 0.03 + kSkin, 3e-3);
  const double share = (0.15 - step.positions[2]) / 0.20;
  EXPECT_NEAR(step.positions[0], 0.02 + share * 0.08, 1e-9) << "on the way, not along the table";
  EXPECT_EQ(step.ghost.reason, GhostReason::contact);
  EXPECT_EQ(step.ghost.words, "tool touches table");
  EXPECT_LT((step.ghost.T_base_hand.translation() - Vector3d(0.10, 0.01, -0.05)).norm(), 1e-12);
  const std::vector<double> there(gantry.hand.positions().begin(), gantry.hand.positions().end());
  EXPECT_FALSE(gantry.hand.go_to(std::vector<double>{0, 0, std::nan("")}, {}).valid);
  EXPECT_FALSE(gantry.hand.go_to(std::vector<double>{0, 0}, {}).valid);
  EXPECT_TRUE(std::ranges::equal(gantry.hand.positions(), there));
}

TEST(SlidingHand, GoesOnFromWhereItIsPut) {
  const SceneModel scene = table();
  Gantry gantry(&scene);
  for (int i = 1; i <= 60; ++i) gantry.go(0, 0, 0.2 - 0.006 * i);  // leans on the table
  ASSERT_TRUE(gantry.hand.stand_at(std::vector<double>{0.3, 0.2, 0.4}));
  const HandStep step = gantry.go(0.3, 0.2, 0.4);
  EXPECT_LT((step.T_base_tip.translation() - Vector3d(0.3, 0.2, 0.4)).norm(), 1e-9);
  EXPECT_FALSE(step.ghost.shown);
  EXPECT_FALSE(gantry.hand.stand_at(std::vector<double>{0.3, std::nan(""), 0.4}));
  EXPECT_FALSE(gantry.hand.stand_at(std::vector<double>{0.3}));
  EXPECT_EQ(gantry.hand.positions()[0], 0.3);
}

TEST(SlidingHand, WhatIsNotKnownMovesNothing) {
  const SceneModel scene = table();
  Gantry gantry(&scene);
  const std::vector<double> before(gantry.hand.positions().begin(), gantry.hand.positions().end());
  const double none = std::numeric_limits<double>::quiet_NaN();
  HandStep step = gantry.go(none, 0, 0);
  EXPECT_FALSE(step.valid);
  EXPECT_EQ(step.ghost.reason, GhostReason::bad_target);
  EXPECT_THAT(step.ghost.words, HasSubstr("no finite rigid pose"));
  step = gantry.hand.step(shifted(0, 0, 0.1), std::vector{0.0, none, 0.0}, {}, kPicture);
  EXPECT_FALSE(step.valid);
  const std::vector<Pose> lost{shifted(none, 0, 0)};
  step = gantry.hand.step(shifted(0, 0, 0.1), std::vector(3, 0.0), lost, kPicture);
  EXPECT_FALSE(step.valid);
  EXPECT_EQ(step.ghost.reason, GhostReason::unknown);
  EXPECT_TRUE(step.ghost.shown);
  EXPECT_EQ(std::vector<double>(gantry.hand.positions().begin(), gantry.hand.positions().end()), before);
  EXPECT_THROW(Gantry(&scene, {0, 0}), InputError);
  EXPECT_THROW(Gantry(&scene, {0, 0, none}), InputError);
}

}  // namespace
}  // namespace foresight::sliding_hand_test
