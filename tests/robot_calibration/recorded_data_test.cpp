// Recorded arms, cameras and a positioner: bars that were measured with other programs.
#include "calibration/robot/hand_eye.hpp"
#include "calibration/robot/pan_tilt.hpp"
#include "calibration/robot/robot_poses.hpp"
#include "calibration/robot/time_offset.hpp"
#include "calibration/target/image_input.hpp"
#include "scene/text_table.hpp"
#include "scene/yaml_fields.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::recorded_data_test {
namespace {

HandEyeData read_session(const std::filesystem::path& folder, const std::string& board_text) {
  const Board board = parse_board(board_text);
  HandEyeData data;
  data.corners = find_in_folder(folder / "images", board).corners;
  std::vector<std::string> names;
  for (const BoardView& view : data.corners.views) names.push_back(view.name);
  for (const Pose& pose :
       match_poses(read_robot_poses(folder / "poses", PoseUnit::automatic).poses, names, names).poses)
    data.poses.push_back({pose, {}});
  if (board.kind == BoardKind::circles) data.cols = board.cols, data.rows = board.rows;
  return data;
}

// Joint bundle adjustment, intrinsics free, each view predicted by the others: 1.75 px, 0.88 mm.
TEST(RecordedData, CharucoOnAnArmBeforeAFixedCamera) {
  FORESIGHT_NEED_DATA("rct_arm_handeye");
  const HandEyeData data =
      read_session(data_folder() / "rct_arm_handeye/test_set_charuco", "charuco:5x7:0.036195:0.018256:DICT_6X6_250");
  ASSERT_EQ(data.corners.views.size(), 9u);
  const HandEyeSummary summary = solve_hand_eye(data, {});
  EXPECT_EQ(summary.mount, CameraMount::fixed);
  EXPECT_LE(summary.loo_px, 1.75);
  EXPECT_LE(summary.loo_mm, 0.88);
  EXPECT_LE(summary.rejected_points, 4);
  EXPECT_NEAR(summary.camera.lens[0], 1352, 10);  // the publisher's
  EXPECT_LT((summary.X.translation() - Eigen::Vector3d(-0.020, 1.278, 0.284)).norm(), 0.03);
}

// Published focal lengths 542.3 and 543.5 px.
TEST(RecordedData, CircleGridBeforeACameraInHand) {
  FORESIGHT_NEED_DATA("rct_arm_handeye");
  const HandEyeData data = read_session(data_folder() / "rct_arm_handeye/test_set_10x10", "circles:10x10:0.0254");
  ASSERT_GE(data.corners.views.size(), 13u);
  const HandEyeSummary summary = solve_hand_eye(data, {});
  EXPECT_EQ(summary.mount, CameraMount::moving);
  EXPECT_NEAR(summary.camera.lens[0], 542.3, 0.005 * 542.3);
  EXPECT_NEAR(summary.camera.lens[1], 543.5, 0.005 * 543.5);
  EXPECT_LT(summary.loo_px, 3.9);  // this arm reports its poses to 3 mm and 5 mrad only, two of them worse
  EXPECT_LT(summary.loo_mm, 5.5);
}

// Measured with another program: -20 ms by correlation, 3.3 mm of scatter.
TEST(RecordedData, ClockOfAnArmAndItsCamera) {
  FORESIGHT_NEED_DATA("handeye_pose_streams");
  const auto folder = data_folder() / "handeye_pose_streams/robot_arm_w_color_camera_real";
  const PoseStream encoder = read_pose_stream(folder / "robot_arm_complete_bag_color_and_ir_base_link_sr300_hinge.csv");
  const PoseStream camera = read_pose_stream(folder / "robot_arm_complete_bag_color_and_ir_target_ir.csv");
  const TimeOffsetSummary summary = solve_time_offset(encoder.samples, camera.samples, {});
  EXPECT_NEAR(summary.offset_s, -0.020, 0.010);
  EXPECT_GT(summary.offset_sigma_s, 1e-4);
  EXPECT_LT(summary.offset_sigma_s, 5e-3);
  EXPECT_LE(summary.scatter_mm, 3.5);
}

TEST(RecordedData, PositionerOfTwoAxes) {
  FORESIGHT_NEED_DATA("rct_arm_handeye");
  const YamlMap file = YamlMap::load(data_folder() / "rct_arm_handeye/positioner_kinematic_measurements.yaml");
  std::vector<PanTiltSample> samples;
  for (const std::string& name : file.keys()) {
    const YamlMap entry = file.map(name), pose = entry.map("pose");
    const auto joints = entry.numbers("target_joints", 2);
    const Eigen::Vector4d q(pose.number("qx"), pose.number("qy"), pose.number("qz"), pose.number("qw"));
    samples.push_back({name,
                       {joints[0], joints[1], {}},
                       checked_pose({pose.number("x"), pose.number("y"), pose.number("z")}, q, name)});
  }
  ASSERT_EQ(samples.size(), 205u);
  const PanTiltSummary robust = solve_pan_tilt(samples, {});
  PanTiltOptions plain_options;
  plain_options.robust = false;
  plain_options.gains = false;
  const PanTiltSummary plain = solve_pan_tilt(samples, plain_options);
  EXPECT_LT(robust.loo.mm, plain.loo.mm);
  EXPECT_LT(robust.loo.mrad, plain.loo.mrad);
  EXPECT_LT(robust.loo.mm, 0.40);  // of 0.42 for plain least squares of the same kinematics
  EXPECT_GT(robust.loo.mm, robust.in_sample.mm);
  EXPECT_LT(robust.loo.mm, 1.1 * robust.in_sample.mm);
}

}  // namespace
}  // namespace foresight::recorded_data_test
