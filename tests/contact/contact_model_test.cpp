#include "prediction/contact/contact_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "common/error.hpp"
#include "scene/primitives.hpp"
#include "tests/contact/made_robot.hpp"

namespace foresight::contact_model_test {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double any(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

std::vector<double> any_lab_arm(const UrdfRobot& robot, std::mt19937_64& random) {
  std::vector<double> q;
  for (std::size_t i = 0; i < 8; ++i) q.push_back(any(random, robot.joints[i].lower, robot.joints[i].upper));
  return q;
}

Pose lab_stand() {
  return shifted(-0.1, -0.75, -0.75);
}

// Boxes whose sides stay parallel: the distance is that of two intervals in each direction.
TEST(ContactModel, BoxesAreAsFarApartAsTheirSidesSay) {
  const Vector3d tool(0.1, 0.06, 0.08), block(0.2, 0.3, 0.1);
  const SceneModel scene = made_scene({{"block", make_box(block), Pose::Identity()}});
  ContactModel model(made_gantry(make_box(tool)), gantry_joints(), &scene, Pose::Identity(), "test");
  std::mt19937_64 random(1);
  int near = 0, touching = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d at(any(random, -0.25, 0.25), any(random, -0.25, 0.25), any(random, -0.2, 0.2));
    ASSERT_EQ(model.pose(std::vector{at.x(), at.y(), at.z()}), nullptr);
    const Vector3d apart = (at.cwiseAbs() - 0.5 * (tool + block)).cwiseMax(0);
    const bool inside = ((at.cwiseAbs() + 0.5 * tool).array() < 0.5 * block.array()).all();
    const auto least = model.least();
    if (apart.norm() > 1e-6) {
      EXPECT_TRUE(model.touching().empty());
    }
    if (apart.norm() > 1e-6 && apart.norm() < kContactReach - 1e-6) {
      ++near;
      ASSERT_TRUE(least);
      EXPECT_NEAR(least->distance, apart.norm(), 1e-7);  // vertices are floats
      EXPECT_NEAR((least->point - least->other_point).norm(), apart.norm(), 1e-7);
      EXPECT_LT((least->point - least->other_point - least->distance * least->direction).norm(), 1e-9);
    } else if (apart.norm() > kContactReach + 1e-6) {
      EXPECT_FALSE(least);
    } else if (apart.norm() == 0 && !inside) {
      ++touching;
      ASSERT_EQ(model.touching(), std::vector<std::size_t>{0});
      EXPECT_EQ(least->distance, 0);
      EXPECT_EQ(model.name(0) + " " + model.other_name(0), "tool block");
    }
  }
  EXPECT_GT(near, 200);
  EXPECT_GT(touching, 200);
}

TEST(ContactModel, ABallOverAPlaneIsItsHeightLessItsRadiusAway) {
  const SceneModel scene = made_scene({{"table", make_box({1, 1, 0.02}), shifted(0, 0, -0.01)}});
  ContactModel model(made_gantry(make_sphere(0.03)), gantry_joints(), &scene, Pose::Identity(), "test");
  for (const double height : {0.0305, 0.04, 0.07}) {
    model.pose(std::vector{0.1, -0.2, height});
    const auto least = model.least();
    ASSERT_TRUE(least);
    EXPECT_NEAR(least->distance, height - 0.03, 1e-7);
    EXPECT_LT((least->direction - Vector3d(0, 0, 1)).norm(), 1e-6);
    EXPECT_LT((least->other_point - Vector3d(0.1, -0.2, 0)).norm(), 1e-5);
  }
}

TEST(ContactModel, DepthIsTheShortestWayOut) {
  const SceneModel scene = made_scene({{"table", make_box({1, 1, 0.5}), shifted(0, 0, -0.25)}});
  for (const Mesh& tool : {make_box({0.06, 0.06, 0.06}), make_sphere(0.03)}) {
    ContactModel model(made_gantry(tool), gantry_joints(), &scene, Pose::Identity(), "test");
    for (const double depth : {0.0005, 0.002, 0.02}) {
      model.pose(std::vector{0.1, -0.2, 0.03 - depth});
      ASSERT_EQ(model.touching().size(), 1U);
      const Penetration deep = model.penetration(0);
      EXPECT_NEAR(deep.depth, depth, 1.1e-5);
      EXPECT_LT((deep.direction - Vector3d(0, 0, 1)).norm(), 1e-6);
    }
    model.pose(std::vector{0.1, -0.2, 0.04});
    EXPECT_EQ(model.penetration(0).depth, 0);
  }
}

TEST(ContactModel, NeighboursAndWhatAlwaysOverlapsAreLeftOut) {
  const UrdfRobot robot = made_lab_arm();
  const SceneModel scene = made_scene({{"plinth", make_box({0.4, 0.4, 0.1}), lab_stand() * shifted(0, 0, 0.98)}});
  ContactModel model(robot, lab_arm_joints(), &scene, lab_stand(), "test");
  EXPECT_THAT(model.always_overlapping(), testing::Contains("arm_1 and plinth"));
  for (std::size_t i = 0; i < model.couples(); ++i) {
    const std::string both = model.name(i) + " " + model.other_name(i);
    EXPECT_NE(both, "arm_2 arm_1");
    EXPECT_NE(both, "finger_right finger_left");  // one joint moves both
    EXPECT_NE(both, "stand plinth");              // neither moves
    EXPECT_NE(both, "arm_1 plinth");
  }
  model.pose(std::vector<double>{0, 1.9, 0, 2.35, 0, 0, 0, 0.02});
  EXPECT_FALSE(model.touching().empty());  // folded onto itself, and into the plinth
}

TEST(ContactModel, ACarriedThingMovesWithItsLinkAndMayTouchWhatHoldsIt) {
  const SceneModel scene = made_scene(
      {{"thing", make_box({0.05, 0.03, 0.05}), shifted(3, 0, 0)}, {"wall", made_sheet(2), shifted(2, 0, 0)}});
  const UrdfRobot robot = made_lab_arm();
  ContactModel model(robot, lab_arm_joints(), &scene, Pose::Identity(), "test");
  const std::size_t before = model.couples();
  const std::vector<double> q{0, 0.9, 0, 0.9, 0, -0.3, 0, 0.015};
  model.pose(q);
  EXPECT_TRUE(model.touching().empty());
  model.attach(0, 7, shifted(0, 0, 0.12));
  EXPECT_TRUE(model.touching().empty());  // between the fingers
  EXPECT_GT(model.couples(), before - 10);
  bool against_wall = false, against_arm = false;
  for (std::size_t i = 0; i < model.couples(); ++i) {
    if (model.name(i) != "thing") continue;
    against_wall = against_wall || model.other_name(i) == "wall";
    against_arm = against_arm || model.other_name(i) == "arm_2";
    EXPECT_NE(model.other_name(i), "arm_7");
    EXPECT_NE(model.other_name(i), "finger_left");
  }
  EXPECT_TRUE(against_wall && against_arm);
  const Vector3d carried = model.links().T_world_link(7) * Vector3d(0, 0, 0.12);
  std::vector<Pose> nodes{shifted(3, 0, 0), shifted(carried.x() + 0.1, 0, carried.z())};
  model.pose(q, nodes);
  double farthest = -1;  // towards the wall
  for (const auto& v : scene.nodes()[0].mesh.vertices)
    farthest = std::max(farthest, (model.links().T_world_link(7) * shifted(0, 0, 0.12) * v.cast<double>()).x());
  double found = -1;
  for (const Nearness& n : model.near(0.2))
    if (model.name(n.couple) == "thing" && model.other_name(n.couple) == "wall") found = n.distance;
  EXPECT_NEAR(found, carried.x() + 0.1 - farthest, 1e-7);
  model.detach(0);
  EXPECT_EQ(model.couples(), before);
  EXPECT_THROW(model.attach(5, 7, Pose::Identity()), std::invalid_argument);
  EXPECT_THROW(model.attach(0, 99, Pose::Identity()), std::invalid_argument);
}

// Hints of the last picture make answers come sooner, and change none.
TEST(ContactModel, TheSameAnswerWhateverTheHistory) {
  const UrdfRobot robot = made_lab_arm();
  const SceneModel scene = lab_without_arm();
  ContactModel model(robot, lab_arm_joints(), &scene, lab_stand(), "test");
  ContactModel fresh(robot, lab_arm_joints(), &scene, lab_stand(), "test");
  std::mt19937_64 random(3);
  std::size_t compared = 0;
  for (int walk = 0; walk < 20; ++walk) {
    std::vector<double> q = any_lab_arm(robot, random);
    for (int i = 0; i < 15; ++i) {
      for (double& x : q) x += any(random, -0.02, 0.02);
      model.pose(q);
      const auto got = model.near();
      fresh.forget();
      fresh.pose(q);
      const auto expected = fresh.near();
      ASSERT_EQ(got.size(), expected.size());
      for (std::size_t k = 0; k < got.size(); ++k) {
        ++compared;
        ASSERT_EQ(got[k].couple, expected[k].couple);
        ASSERT_EQ(got[k].distance, expected[k].distance);
        ASSERT_TRUE(got[k].point == expected[k].point && got[k].other_point == expected[k].other_point);
      }
      const auto least = model.least();
      ASSERT_EQ(least.has_value(), !expected.empty());
      if (least) {
        EXPECT_EQ(least->distance, expected[0].distance);
      }
    }
  }
  EXPECT_GT(compared, 300U);
}

TEST(ContactModel, ChangesOfDistanceAreItsDerivatives) {
  const UrdfRobot robot = made_lab_arm();
  const SceneModel scene = made_scene({{"ball", make_sphere(0.05), shifted(0.45, 0.1, 1.2)}});
  ContactModel model(robot, lab_arm_joints(), &scene, Pose::Identity(), "test");
  std::mt19937_64 random(4);
  int checked = 0;
  for (int i = 0; i < 3000 && checked < 60; ++i) {
    std::vector<double> q = any_lab_arm(robot, random);
    model.pose(q);
    const auto least = model.least();
    if (!least || least->distance < 0.002) continue;
    const std::vector<double> change = model.change_of(*least, least->direction);
    std::vector<double> step(q.size());
    double expected = 0;
    for (std::size_t k = 0; k < q.size(); ++k) {
      step[k] = any(random, -1e-6, 1e-6);
      expected += change[k] * step[k];
      q[k] += step[k];
    }
    const double way = model.farthest(least->couple, step);
    model.pose(q);
    const auto then = model.near();
    const auto found = std::ranges::find(then, least->couple, &Nearness::couple);
    ASSERT_NE(found, then.end());
    EXPECT_LE(std::abs(found->distance - least->distance), way + 1e-9);
    EXPECT_NEAR(found->distance - least->distance, expected, 1e-7);
    ++checked;
  }
  EXPECT_EQ(checked, 60);
}

TEST(ContactModel, NoPointGoesFartherThanTold) {
  const UrdfRobot robot = made_lab_arm();
  const std::vector<std::string> names = lab_arm_joints();
  PosedLinks now(robot, names, Pose::Identity(), "test"), then(robot, names, Pose::Identity(), "test");
  std::mt19937_64 random(5);
  for (int i = 0; i < 300; ++i) {
    std::vector<double> q = any_lab_arm(robot, random), step(q.size());
    now.pose(q);
    const double size = any(random, 0, 1);
    for (std::size_t k = 0; k < q.size(); ++k) q[k] += step[k] = any(random, -size, size);
    then.pose(q);
    for (const std::size_t link : {3, 5, 8}) {
      const Mesh& body = robot.body(link);
      double radius = 0, farthest = 0;
      for (const auto& v : body.vertices) {
        radius = std::max(radius, v.cast<double>().norm());
        farthest = std::max(
            farthest, (now.T_world_link(link) * v.cast<double>() - then.T_world_link(link) * v.cast<double>()).norm());
      }
      const double told =
          now.farthest(now.joints_between(link, -1), now.T_world_link(link).translation(), radius, step);
      ASSERT_LE(farthest, told + 1e-9);
    }
  }
}

TEST(ContactModel, BadInputIsSaidInWords) {
  try {
    ContactModel(made_gantry({}), gantry_joints(), nullptr, Pose::Identity(), "arm.urdf");
    FAIL() << "a robot without shapes";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("no link of the robot has a shape"));
  }
  const Mesh tool = make_box({0.1, 0.1, 0.1});
  EXPECT_THROW(ContactModel(made_gantry(tool), {"x", "y", "w"}, nullptr, Pose::Identity(), "arm.urdf"), InputError);

  ContactModel alone(made_gantry(tool), gantry_joints(), nullptr, Pose::Identity(), "test");
  EXPECT_EQ(alone.pose(std::vector{0.0, 0.0, 0.0}), nullptr);
  EXPECT_TRUE(alone.near().empty() && alone.touching().empty() && !alone.least());
  EXPECT_THAT(alone.pose(std::vector{0.0, kNone, 0.0}), HasSubstr("without a position"));
  EXPECT_FALSE(alone.valid());
  EXPECT_THAT(alone.pose(std::vector{0.0}), HasSubstr("not one position for each joint"));

  const SceneModel scene = made_scene({{"block", tool, shifted(0.12, 0, 0)}});
  ContactModel model(made_gantry(tool), gantry_joints(), &scene, Pose::Identity(), "test");
  EXPECT_EQ(model.pose(std::vector{0.0, 0.0, 0.0}), nullptr);
  EXPECT_EQ(model.near().size(), 1U);
  std::vector<Pose> nodes{Pose::Identity()};
  nodes[0].translation().x() = kNone;
  EXPECT_THAT(model.pose(std::vector{0.0, 0.0, 0.0}, nodes), HasSubstr("no finite rigid pose"));
  EXPECT_TRUE(model.near().empty() && model.touching().empty() && !model.least());
  nodes.push_back(Pose::Identity());
  EXPECT_THAT(model.pose(std::vector{0.0, 0.0, 0.0}, nodes), HasSubstr("one pose for each node"));
}

TEST(ContactModel, TrianglesThatAreNoneAreLeftOut) {
  Mesh broken = make_box({0.1, 0.1, 0.1});
  const auto at = static_cast<std::uint32_t>(broken.vertices.size());
  broken.vertices.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});
  broken.triangles.push_back({0, 0, 1});
  broken.triangles.push_back({0, 1, at});
  broken.triangles.push_back({0, 1, 4'000'000'000U});
  const SceneModel scene = made_scene(
      {{"block", broken, shifted(0.12, 0, 0)}, {"nothing", {{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}, 0}, {}}});
  ContactModel model(made_gantry(broken), gantry_joints(), &scene, Pose::Identity(), "test");
  EXPECT_EQ(model.couples(), 1U);
  EXPECT_THAT(model.remarks(), testing::Contains("block: 3 triangles without area are left out"));
  model.pose(std::vector{0.0, 0.0, 0.0});
  const auto least = model.least();
  ASSERT_TRUE(least);
  EXPECT_NEAR(least->distance, 0.02, 1e-7);
}

}  // namespace
}  // namespace foresight::contact_model_test
