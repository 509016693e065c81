#include "scene/robot_scene.hpp"

#include <gtest/gtest.h>

#include "tests/support/folders.hpp"

namespace foresight::robot_scene_test {
namespace {

TEST(RobotScene, KnowsWhatMayMoveBeforeItHas) {
  const TempFolder folder;
  const auto link = [](const std::string& name) {
    return "<link name='" + name + "'><visual><geometry><box size='0.1 0.1 0.1'/></geometry></visual></link>";
  };
  const auto joint = [](const std::string& name, const std::string& kind, const std::string& from,
                        const std::string& to) {
    return "<joint name='" + name + "' type='" + kind + "'><parent link='" + from + "'/><child link='" + to +
           "'/><limit lower='0' upper='1' effort='1' velocity='1'/></joint>";
  };
  const std::string file = folder.write(
      "mast.urdf", "<robot name='mast'>" + link("foot") + link("mast") + link("sledge") + link("lamp") +
                       joint("bolts", "fixed", "foot", "mast") + joint("slide", "prismatic", "mast", "sledge") +
                       joint("clamp", "fixed", "sledge", "lamp") + "</robot>");
  const UrdfRobot robot = read_urdf(file, folder.path());
  const RobotScene scene(nullptr, robot, Pose::Identity());
  std::map<std::string, bool> moves;
  for (std::size_t i = 0; i < scene.nodes().size(); ++i) {
    moves[scene.nodes()[i].name] = scene.moves(i);
    EXPECT_EQ(scene.model()->nodes()[i].may_move, scene.moves(i));
  }
  EXPECT_EQ(moves, (std::map<std::string, bool>{{"foot", false}, {"mast", false}, {"sledge", true}, {"lamp", true}}));

  // A scene that knows the links by name, flat, and a cup that somebody put on the lamp.
  std::vector<Node> nodes = scene.nodes();
  for (Node& node : nodes) node.parent = -1, node.may_move = false;
  nodes.push_back({"cup", nodes[0].mesh, 3, Pose::Identity()});
  const SceneModel known(nodes);
  const RobotScene found(&known, robot, Pose::Identity());
  for (std::size_t i = 0; i < nodes.size(); ++i) EXPECT_EQ(found.moves(i), i >= 2) << nodes[i].name;
}

}  // namespace
}  // namespace foresight::robot_scene_test
