// A robot that is not the lab's, from its URDF to a replayed run, before mock cameras.
#include <algorithm>

#include "scene/primitives.hpp"
#include "scene/run_folder.hpp"
#include "scene/scene_writer.hpp"
#include "tests/apps/program.hpp"
#include "tests/apps/runs.hpp"

namespace foresight::own_robot_seen_test {
namespace {

using testing::HasSubstr;

/// A turntable with a mast that slides up, beside a box.
class OwnRobotSeen : public testing::Test {
 protected:
  void SetUp() override {
    folder_.write("urdf/turner.urdf", R"(<robot name="turner">
  <link name="foot"><visual><origin xyz="0 0 0.03"/><geometry><box size="0.3 0.3 0.06"/></geometry></visual></link>
  <link name="table"><visual><origin xyz="0.03 0 0.06"/><geometry><box size="0.26 0.16 0.1"/></geometry></visual></link>
  <link name="mast"><visual><origin xyz="0 0 0.08"/><geometry><cylinder radius="0.04" length="0.2"/></geometry></visual></link>
  <link name="tip"/>
  <joint name="turn" type="revolute"><parent link="foot"/><child link="table"/><origin xyz="0 0 0.07"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="1" velocity="2"/></joint>
  <joint name="lift" type="prismatic"><parent link="table"/><child link="mast"/><origin xyz="0.03 0 0.11"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="0.1" effort="1" velocity="1"/></joint>
  <joint name="tip_joint" type="fixed"><parent link="mast"/><child link="tip"/><origin xyz="0 0 0.18"/></joint>
</robot>)");
    std::filesystem::create_directory(folder_ / "around");
    Pose below = Pose::Identity(), beside = Pose::Identity();
    below.translation() = Eigen::Vector3d(0, 0, -0.05);
    beside.translation() = Eigen::Vector3d(0.1, 0.35, 0.1);
    write_model(folder_ / "around", SceneModel({{"ground", make_box({1.6, 1.6, 0.1}), -1, below},
                                                {"crate", make_box({0.2, 0.2, 0.2}), -1, beside}}));
    folder_.write("rig.yaml", R"(name: turner
robot: {urdf: urdf/turner.urdf, pose: {xyz: [0.05, -0.1, 0], quaternion: [0, 0, 0, 1]}}
scene: around/scene.yaml
buses:
  - {name: all, interface: mock, protocol: cia402, bit_rate: 1000000}
cameras:
  left: {driver: mock, size_px: [160, 120], rate_hz: 5}
  right: {driver: mock, size_px: [160, 120], rate_hz: 5}
joints:
  - {name: turn, group: arm, bus: all, node: 1, unit: rad, encoder: absolute, counts_per_unit: 2000000,
     min: -2, max: 2, velocity: 1, acceleration: 2, jerk: 30, following_error: 0.1}
  - {name: lift, group: arm, bus: all, node: 2, unit: m, encoder: absolute, counts_per_unit: 2000000,
     min: 0, max: 0.1, velocity: 0.1, acceleration: 0.5, jerk: 10, following_error: 0.01}
)");
    folder_.write("motion.csv", "time_s,turn,lift\n0,0,0\n2,0.9,0.08\n3,0.9,0.08\n");
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  TempFolder folder_;
};

TEST_F(OwnRobotSeen, IsSeenRecordedAndReplayedAtOnce) {
  const Outcome robot =
      run_program({"robot", path("rig.yaml"), "--stepped", "--follow", path("motion.csv"), "--record", path("run")});
  ASSERT_EQ(robot.exit_code, 0) << robot.err << robot.out;

  const RunFolder run = RunFolder::open(folder_ / "run", {});
  for (const char* name : {"ground", "crate", "foot", "table", "mast", "tip"})
    EXPECT_TRUE(run.scene()->find(name)) << name;
  EXPECT_FALSE(run.scene()->find("room")) << "the lab's own things stand beside the rig's scene";
  ASSERT_GT(run.frames().size(), 10u);
  const std::string nodes = folder_.read("run/nodes.txt");
  for (const char* name : {" table ", " mast ", " tip "}) EXPECT_THAT(nodes, HasSubstr(name));
  const auto height_of = [&](const RunFrame& frame, const char* node) {
    const auto at = static_cast<std::size_t>(run.scene()->find(node).value());
    return run.state_at(frame.left.time).T_world_node[at].translation().z();
  };
  EXPECT_NEAR(height_of(run.frames().front(), "tip"), 0.36, 0.004);
  EXPECT_NEAR(height_of(run.frames().back(), "tip"), 0.44, 0.004);
  EXPECT_THAT(folder_.read("run-joints.csv"), HasSubstr("time_s,turn,lift"));

  const Outcome replay = run_program({"replay", path("run"), "--delay-ms", "600", "--report", path("replay.json")});
  ASSERT_EQ(replay.exit_code, 0) << replay.err;
  const auto summary = read_json(folder_ / "replay.json").at("summary");
  EXPECT_GT(summary.at("coverage").at("seen").get<double>(), 0.3) << summary.dump(1);
  // The head stands still: only where the robot moves does the delayed image differ, and there the links must be drawn.
  const auto worst = [&summary](const char* of) { return summary.at(of).at("psnr_db").at("min").get<double>(); };
  EXPECT_GT(worst("predicted"), worst("delayed"))
      << "the links of the images are not where the nodes say; " << summary.dump(1);
}

TEST_F(OwnRobotSeen, ASceneThatCannotBeReadIsNamedBeforeAnythingMoves) {
  folder_.write("around/scene.yaml", "nodes:\n  - {name: ground, mesh: gone.ply}\n");
  const Outcome out = run_program({"robot", path("rig.yaml"), "--stepped", "--record", path("run")});
  EXPECT_EQ(out.exit_code, 2);
  EXPECT_THAT(out.last_line(), testing::AllOf(HasSubstr("scene.yaml"), HasSubstr("gone.ply")));
  std::filesystem::remove(folder_ / "around/scene.yaml");
  const Outcome none = run_program({"robot", path("rig.yaml"), "--stepped", "--no-cameras"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.last_line(), testing::AllOf(HasSubstr("rig.yaml"), HasSubstr("scene"), HasSubstr("no file")));
}

}  // namespace
}  // namespace foresight::own_robot_seen_test
