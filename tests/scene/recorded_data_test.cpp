// Real runs and robots, where they are at hand.
#include "scene/mesh_reader.hpp"
#include "scene/run_folder.hpp"
#include "scene/urdf_reader.hpp"
#include "test_run.hpp"

namespace foresight::recorded_data_test {
namespace {

TEST(RecordedData, ToteBox) {
  FORESIGHT_NEED_DATA("tote_box");
  const RunFolder run = RunFolder::open(data_folder() / "tote_box", {});
  ASSERT_EQ(run.frames().size(), 50u);
  EXPECT_EQ(run.lens_left().width(), 640);
  EXPECT_EQ(run.frames()[1].left.time.ns, 566'667'000);
  for (const RunFrame& frame : run.frames()) EXPECT_EQ(frame.left.pose_status, StateStatus::exact);
  const Node& scene = run.scene()->nodes()[0];
  EXPECT_EQ(scene.mesh.triangles.size() + scene.mesh.dropped_degenerate, 5000u);
  EXPECT_GT(run.scene()->diagonal(), 0.5);
  EXPECT_LT(run.scene()->diagonal(), 5);
  check_run_images(run, {});
}

UrdfRobot read_robot(const std::string& file) {
  const auto root = std::filesystem::canonical(data_folder() / "robots");
  return read_urdf(root / file, root);
}

TEST(RecordedData, PandaReachesItsKnownPose) {
  FORESIGHT_NEED_DATA("robots/panda");
  UrdfRobot robot = read_robot("panda/diff_robot_data/panda_description/urdf/panda.urdf");
  const auto triangles = [&] {
    std::size_t n = 0;
    for (const Node& link : robot.links) n += link.mesh.triangles.size();
    return n;
  };
  EXPECT_GT(triangles(), 10'000u);
  const auto find = [&](const std::string& name) {
    std::vector<Pose> T;
    for (const Node& node : robot.links) {
      T.push_back(node.parent < 0 ? node.T_parent_node : T[static_cast<std::size_t>(node.parent)] * node.T_parent_node);
      if (node.name == name) return T.back();
    }
    return Pose(Eigen::Translation3d(99, 99, 99));
  };
  // The flange of Franka's Denavit-Hartenberg table with all joints at 0: x = a4 + a5 + a7 = 0.088,
  // z = d1 + d3 + d5 - df = 0.333 + 0.316 + 0.384 - 0.107. Joint 4 may not stand at 0, so its
  // limit is lifted for the check.
  for (UrdfJoint& joint : robot.joints)
    if (joint.name == "panda_joint4") joint.upper = 0;
  pose_links(robot, {}, "test");
  EXPECT_TRUE(find("panda_virtual_ee_link").linear().allFinite());
  EXPECT_TRUE(find("panda_hand").translation().isApprox(Eigen::Vector3d(0.088, 0, 0.926), 1e-9))
      << find("panda_hand").translation().transpose();
  // The fingers mimic each other: both move out by the same way.
  pose_links(robot, {{"panda_finger_joint1", 0.03}}, "test");
  const Pose T_hand = find("panda_hand");
  const double left = (T_hand.inverse() * find("panda_leftfinger")).translation().y();
  const double right = (T_hand.inverse() * find("panda_rightfinger")).translation().y();
  EXPECT_NEAR(left, 0.03, 1e-9);
  EXPECT_NEAR(right, -0.03, 1e-9);
}

TEST(RecordedData, AllLinksOfIiwaFindTheirMeshes) {
  FORESIGHT_NEED_DATA("robots/iiwa7");
  const UrdfRobot robot = read_robot("iiwa7/diff_robot_data/kuka_iiwa/urdf/iiwa7.urdf");
  int with_mesh = 0;
  for (const Node& link : robot.links) with_mesh += link.mesh.triangles.empty() ? 0 : 1;
  EXPECT_EQ(with_mesh, 8);
}

TEST(RecordedData, RobotMeshesAreReadable) {
  FORESIGHT_NEED_DATA("robots/schunk");
  int read = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(data_folder() / "robots/schunk"))
    if (entry.path().extension() == ".stl" || entry.path().extension() == ".dae") {
      EXPECT_GT(read_mesh(entry.path()).triangles.size(), 10u) << entry.path();
      ++read;
    }
  EXPECT_GT(read, 20);
}

}  // namespace
}  // namespace foresight::recorded_data_test
