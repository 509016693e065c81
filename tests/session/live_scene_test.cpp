#include "session/live_scene.hpp"

#include "scene/scene_reader.hpp"
#include "scene/scene_writer.hpp"
#include "sim/run_files.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/folders.hpp"

namespace foresight::live_scene_test {
namespace {

Rig lab_rig() {
  return read_rig(source_folder() / "configs/minerva.yaml");
}

/// The arm a little bent, pan turned.
std::optional<double> bent(std::string_view joint) {
  if (joint == "elbow") return 0.7;
  if (joint == "shoulder_yaw") return -0.4;
  if (joint == "finger") return 0.02;
  if (joint == "pan") return 0.3;
  return std::nullopt;
}

std::optional<double> stretched(std::string_view joint) {
  if (joint == "pan" || joint == "tilt") return std::nullopt;
  return bent(joint).value_or(0);
}

TEST(LiveScene, TheMockLabsModelIsWhatSynthWrites) {
  const auto world = std::make_shared<const sim::LiveLab>(sim::LiveLab::Options{.texel = 0.02});
  const LiveScene scene(world, {});
  const TempFolder folder;
  sim::ArmPosition rest;
  for (std::size_t j = 0; j < rest.joints.size(); ++j) rest.joints[j] = *sim::shafts_at_rest(sim::arm_joints()[j].name);
  rest.opening = *sim::shafts_at_rest("finger");
  sim::write_scene(folder.path(), world->lab(), rest);
  const SceneModel written = read_scene(folder / "scene.yaml", folder.path());
  const SceneModel& model = *scene.model();
  EXPECT_EQ(model.accuracy(), written.accuracy());
  ASSERT_EQ(model.nodes().size(), written.nodes().size());
  const auto rest_poses = written.rest_poses();
  const SceneState state = scene.state_at({}, sim::shafts_at_rest, StateStatus::exact);
  for (std::size_t i = 0; i < model.nodes().size(); ++i) {
    const Node& node = model.nodes()[i];
    const auto other = written.find(node.name);
    ASSERT_TRUE(other) << node.name;
    const auto at = static_cast<std::size_t>(*other);
    EXPECT_TRUE(node.mesh.vertices == written.nodes()[at].mesh.vertices) << node.name;
    EXPECT_TRUE(node.mesh.triangles == written.nodes()[at].mesh.triangles) << node.name;
    EXPECT_TRUE(state.T_world_node[i].isApprox(rest_poses[at], 1e-9)) << node.name;
    EXPECT_EQ(node.may_move, node.name.starts_with("arm_") || node.name.starts_with("finger_")) << node.name;
  }
}

TEST(LiveScene, ARealRobotsLinksFollowItsJoints) {
  const Rig rig = lab_rig();
  const LiveScene scene(StereoConfig{}, &rig, std::nullopt);
  EXPECT_FALSE(scene.lenses()) << "nobody has calibrated them";
  ASSERT_EQ(scene.model()->nodes().size(), rig.robot->links.size());
  const SceneState state = scene.state_at(RobotTime{7}, stretched, StateStatus::interpolated);
  EXPECT_EQ(state.time, RobotTime{7});
  EXPECT_EQ(state.status, StateStatus::interpolated);
  sim::ArmPosition arm;  // the same arm, by another's hand
  for (std::size_t j = 0; j < arm.joints.size(); ++j) arm.joints[j] = *stretched(sim::arm_joints()[j].name);
  arm.opening = 0.02;
  const auto links = sim::arm_links_at(arm);
  for (std::size_t i = 0; i < links.size(); ++i) {
    const std::string name = i == 0 ? sim::kArmStand : sim::arm_joints()[i - 1].child;
    const auto node = scene.model()->find(name);
    ASSERT_TRUE(node) << name;
    const auto at = static_cast<std::size_t>(*node);
    EXPECT_TRUE(state.T_world_node[at].isApprox(links[i], 1e-9)) << name;
    EXPECT_EQ(scene.model()->nodes()[at].may_move, i > 0) << name;
  }
}

TEST(LiveScene, FindsTheRobotInTheSceneOrAddsIt) {
  const Rig rig = lab_rig();
  const TempFolder folder;
  Mesh triangle;
  triangle.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  triangle.triangles = {{0, 1, 2}};
  write_model(folder.path(), SceneModel(std::vector<Node>{{"table", triangle}}));
  const LiveScene added(StereoConfig{}, &rig, folder / "scene.yaml");
  ASSERT_EQ(added.model()->nodes().size(), 1 + rig.robot->links.size());
  EXPECT_FALSE(added.model()->nodes()[0].may_move);
  const SceneState state = added.state_at({}, bent, StateStatus::exact);

  // A cup in the hand moves along.
  const std::string hand = rig.robot->links.back().name;
  std::vector<Node> nodes = added.model()->nodes();
  Pose beside = Pose::Identity();
  beside.translation().z() = 0.1;
  nodes.push_back({"cup", triangle, static_cast<int>(nodes.size()) - 1, beside});
  write_model(folder.path(), SceneModel(nodes));
  const LiveScene found(StereoConfig{}, &rig, folder / "scene.yaml");
  ASSERT_EQ(found.model()->nodes().size(), nodes.size());
  const SceneState with_cup = found.state_at({}, bent, StateStatus::exact);
  for (std::size_t i = 0; i < state.T_world_node.size(); ++i)
    EXPECT_TRUE(with_cup.T_world_node[i].isApprox(state.T_world_node[i], 1e-9));
  EXPECT_TRUE(with_cup.T_world_node.back().isApprox(state.T_world_node.back() * beside, 1e-9));
  EXPECT_TRUE(found.model()->nodes().back().may_move);

  write_model(folder.path(), SceneModel(std::vector<Node>{{hand, triangle}}));
  EXPECT_THAT(input_error([&] { LiveScene(StereoConfig{}, &rig, folder / "scene.yaml"); }),
              testing::HasSubstr("some of the links"));
}

}  // namespace
}  // namespace foresight::live_scene_test
