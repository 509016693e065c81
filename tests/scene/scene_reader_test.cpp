#include "scene/scene_reader.hpp"

#include "test_run.hpp"

namespace foresight::scene_reader_test {
namespace {

const std::string kArm =
    R"(<robot name="arm"><link name="base"><visual><geometry><box size="1 1 1"/></geometry></visual></link>
<link name="upper"/><joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>
<origin xyz="0 0 1"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>)";

class SceneYamlTest : public testing::Test {
 protected:
  SceneYamlTest() {
    folder_.write("table.ply", kTriangle);
    folder_.write("arm.urdf", kArm);
  }
  SceneModel read(const std::string& yaml) { return read_scene(folder_.write("scene.yaml", yaml), folder_.path()); }
  std::string error(const std::string& yaml) {
    return input_error([&] { read(yaml); });
  }
  TempFolder folder_;
};

TEST_F(SceneYamlTest, AMeshBecomesTheNodeScene) {
  const SceneModel model = read_scene(folder_ / "table.ply", folder_.path());
  ASSERT_EQ(model.nodes().size(), 1u);
  EXPECT_EQ(model.nodes()[0].name, "scene");
}

TEST_F(SceneYamlTest, ReadsNodesAndRobots) {
  const SceneModel model = read(R"(
nodes:
  - name: table
    mesh: table.ply
    pose: {xyz: [1, 2, 3]}
  - {name: tray, parent: table, pose: {quaternion: [0, 0, 1, 0]}}
  - {name: lamp, parent: world}
robots:
  - {urdf: arm.urdf, parent: table, pose: {xyz: [0, 0, 1]}, joints: {shoulder: 0.5}}
  - {urdf: arm.urdf, prefix: second_}
)");
  ASSERT_EQ(model.nodes().size(), 7u);
  EXPECT_EQ(model.nodes()[1].parent, 0);
  EXPECT_EQ(model.nodes()[2].parent, -1);
  EXPECT_EQ(model.nodes()[3].name, "base");
  EXPECT_EQ(model.nodes()[3].parent, 0);
  EXPECT_EQ(model.nodes()[4].parent, 3);
  EXPECT_EQ(model.nodes()[5].name, "second_base");
  EXPECT_EQ(model.nodes()[6].parent, 5);
  const Pose upper = model.rest_poses()[4];
  EXPECT_TRUE(upper.translation().isApprox(Eigen::Vector3d(1, 2, 5)));
  EXPECT_TRUE(upper.linear().isApprox(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()).toRotationMatrix()));
}

TEST_F(SceneYamlTest, NamesWhatIsWrong) {
  const std::string table = "nodes:\n  - {name: table, mesh: table.ply}\n";
  EXPECT_EQ(error(table), "no error");
  EXPECT_THAT(error("node:\n  - {name: a}\n"),
              says("scene.yaml:2: node", "unknown key 'node'", "did you mean 'nodes'?"));
  EXPECT_THAT(error("nodes:\n  - {name: a, mehs: b}\n"), says("scene.yaml:2: nodes[0].mehs", "unknown key", "'mesh'"));
  EXPECT_THAT(error("nodes:\n  - {mesh: table.ply}\n"), says("nodes[0].name", "is missing", "add the key 'name'"));
  EXPECT_THAT(error("nodes:\n  - {name: world, mesh: table.ply}\n"),
              says("nodes[0].name", "'world' cannot name a node", "other than"));
  EXPECT_THAT(error("nodes:\n  - {name: a b, mesh: table.ply}\n"),
              says("nodes[0].name", "'a b' cannot name", "one word"));
  EXPECT_THAT(error(table + "  - {name: table}\n"),
              says("scene.yaml:3: nodes[1].name", "second node is named 'table'", "rename"));
  EXPECT_THAT(error(table + "  - {name: cup, parent: tabel}\n"),
              says("nodes[1].parent", "no node 'tabel'", "did you mean 'table'?"));
  EXPECT_THAT(error("nodes:\n  - {name: a, parent: a}\n"), says("nodes[0].parent", "no node 'a'", "earlier node"));
  EXPECT_THAT(error("nodes:\n  - {name: a, mesh: none.ply}\n"),
              says("nodes[0].mesh", "none.ply is missing", "put it there"));
  EXPECT_THAT(error("nodes:\n  - {name: a, mesh: ../x.ply}\n"), says("nodes[0].mesh", "leaves", "copy the file"));
  EXPECT_THAT(error("nodes:\n  - {name: a, mesh: /x.ply}\n"), says("nodes[0].mesh", "is absolute", "relative"));
  EXPECT_THAT(error("nodes:\n  - {name: a}\n"),
              says("scene.yaml", "the scene has no triangle", "add a node with a mesh"));
  EXPECT_THAT(error("robots: 3\n"), says("scene.yaml:1: robots", "is not a list", "'-'"));
  EXPECT_THAT(error("nodes:\n  - 3\n"), says("scene.yaml:2: nodes[0]", "is not a mapping", "key: value"));
  EXPECT_THAT(error("nodes:\n  - {name: a, pose: {xyz: [0, .nan, 0]}}\n"),
              says("nodes[0].pose.xyz", "'.nan' is not a finite number", "decimal"));
  folder_.write("bad.ply", "ply\n");
  EXPECT_THAT(error("nodes:\n  - {name: a, mesh: bad.ply}\n"), says("bad.ply:2", "without end_header", "export"));
}

TEST_F(SceneYamlTest, NamesWhatIsWrongWithRobots) {
  EXPECT_THAT(error("robots:\n  - {urdf: arm.urdf, joints: {sholder: 0}}\n"),
              says("robots[0].joints", "no joint 'sholder'", "did you mean 'shoulder'?"));
  EXPECT_THAT(error("robots:\n  - {urdf: arm.urdf, joints: {shoulder: 1.5}}\n"),
              says("robots[0].joints", "beyond its limits", "from -1.000000 to 1.000000"));
  EXPECT_THAT(error("robots:\n  - {urdf: arm.urdf, joints: {shoulder: .nan}}\n"),
              says("robots[0].joints.shoulder", "not a finite number", "decimal"));
  EXPECT_THAT(error("robots:\n  - {urdf: arm.urdf, joints: {shoulder: 0, shoulder: 1}}\n"),
              says("robots[0].joints.shoulder", "appears twice", "remove"));
  EXPECT_THAT(error("robots:\n  - {urdf: arm.urdf}\n  - {urdf: arm.urdf}\n"),
              says("robots[1].urdf", "second node is named 'base'", "prefix"));
  EXPECT_THAT(error("robots:\n  - {parent: world}\n"), says("robots[0].urdf", "is missing", "add the key 'urdf'"));
}

}  // namespace
}  // namespace foresight::scene_reader_test
