#include "scene/scene_model.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace foresight::scene_model_test {
namespace {

Mesh triangle() {
  return {{{0, 0, 0}, {3, 0, 0}, {0, 4, 0}}, {{0, 1, 2}}, 0};
}

Pose moved(double x, double y, double z) {
  return Pose(Eigen::Translation3d(x, y, z));
}

std::string refusal(std::vector<Node> nodes) {
  try {
    SceneModel model(std::move(nodes));
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(SceneModel, ChainsRestPosesFromParentToChild) {
  Pose turned = moved(1, 0, 0);
  turned.linear() = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const SceneModel model({{"a", triangle(), -1, turned}, {"b", triangle(), 0, moved(2, 0, 0)}});
  const auto poses = model.rest_poses();
  EXPECT_TRUE(poses[1].translation().isApprox(Eigen::Vector3d(1, 2, 0)));
  EXPECT_EQ(model.triangle_count(), 2u);
  EXPECT_EQ(model.find("b"), 1);
  EXPECT_FALSE(model.find("c"));
}

TEST(SceneModel, DiagonalSpansAllNodesAtRest) {
  EXPECT_DOUBLE_EQ(SceneModel({{"a", triangle(), -1, moved(9, 9, 9)}}).diagonal(), 5);
  EXPECT_DOUBLE_EQ(
      SceneModel({{"a", triangle(), -1, moved(0, 0, 0)}, {"b", triangle(), 0, moved(0, 0, 12)}}).diagonal(), 13);
}

TEST(SceneModel, RefusesWhatIsNoTreeWithTriangles) {
  const Pose I = Pose::Identity();
  EXPECT_EQ(refusal({{"a", triangle(), -1, I}}), "accepted");
  EXPECT_EQ(refusal({}), "a scene needs at least one node");
  EXPECT_EQ(refusal({{"a", {}, -1, I}}), "the scene has no triangle");
  EXPECT_EQ(refusal({{"a", triangle(), 0, I}}), "the parent of node 'a' is not an earlier node");
  EXPECT_EQ(refusal({{"a", triangle(), -2, I}}), "the parent of node 'a' is not an earlier node");
  EXPECT_EQ(refusal({{"a", triangle(), -1, I}, {"a", triangle(), -1, I}}), "two nodes are named 'a'");
}

}  // namespace
}  // namespace foresight::scene_model_test
