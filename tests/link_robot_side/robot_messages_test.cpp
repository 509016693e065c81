#include "link/robot_side/robot_messages.hpp"

#include "link/messages/checks.hpp"
#include "rig/rig_scene.hpp"
#include "session/joint_tracks.hpp"
#include "tests/robot_devices/live_robot.hpp"

namespace foresight::link::robot_messages_test {
namespace {

using namespace std::chrono_literals;

Pose pose_of(const Transform& t) {
  Pose out = Pose::Identity();
  out.translation() = Eigen::Vector3d(t.translation.x, t.translation.y, t.translation.z);
  out.linear() = Eigen::Quaterniond(t.rotation.w, t.rotation.x, t.rotation.y, t.rotation.z).toRotationMatrix();
  return out;
}

/// A robot on its way, and where its joints were by the newest cycle.
class RobotMessages : public testing::Test {
 protected:
  void SetUp() override {
    auto cycles = robot_.robot().cycles();
    robot_.get_moving();
    while (const auto cycle = cycles.take()) {
      tracks_.add(*cycle);
      newest_ = *cycle;
    }
    joints_ = tracks_.at(tracks_.newest());
  }

  LiveRobot robot_{"minerva.yaml"};
  JointTracks tracks_{robot_.rig().joints.size()};
  RobotCycle newest_;
  JointState joints_;
};

TEST_F(RobotMessages, JointStatesAreWhereTheDrivesSay) {
  const auto names = robot_.rig().joint_names();
  const JointStateMessage message = joint_states(joints_, newest_, names, {5, 6});
  EXPECT_EQ(objection(message, {{}, names, {}}), "");
  EXPECT_EQ(message.header.stamp.sec, 5);
  ASSERT_EQ(message.name, names);
  for (std::size_t i = 0; i < names.size(); ++i)
    EXPECT_NEAR(message.position[i], robot_.shaft(i).position, 0.02) << names[i];  // a cycle or two ago
}

TEST_F(RobotMessages, WhatIsNotKnownIsLeftOut) {
  joints_.known[2] = false;
  newest_.joint[3].velocity = NAN;
  const JointStateMessage message = joint_states(joints_, newest_, robot_.rig().joint_names(), {});
  EXPECT_EQ(objection(message), "");
  EXPECT_EQ(message.name.size(), robot_.rig().joints.size() - 1);
  EXPECT_TRUE(message.velocity.empty());
}

// From link to link they lead to where the scene has each link.
TEST_F(RobotMessages, TransformsLeadToEveryLink) {
  const Rig& rig = robot_.rig();
  const auto names = rig.joint_names();
  TFMessage all = static_transforms(*rig.robot, rig.T_world_robot, {});
  const TFMessage moving = link_transforms(*rig.robot, joints_, names, {});
  EXPECT_EQ(objection(all), "");
  EXPECT_EQ(objection(moving), "");
  all.transforms.insert(all.transforms.end(), moving.transforms.begin(), moving.transforms.end());
  std::map<std::string, Pose> T_world{{"world", Pose::Identity()}};
  for (std::size_t round = 0; round < all.transforms.size(); ++round)  // whatever their order
    for (const TransformStamped& t : all.transforms)
      if (const auto parent = T_world.find(t.header.frame_id); parent != T_world.end())
        T_world[t.child_frame_id] = parent->second * pose_of(t.transform);

  const RobotScene scene(nullptr, rig.robot, rig.T_world_robot);
  const auto poses = scene.poses([&](std::string_view joint) -> std::optional<double> {
    const auto at = static_cast<std::size_t>(std::ranges::find(names, joint) - names.begin());
    return at < names.size() ? std::optional(joints_.positions[at]) : std::nullopt;
  });
  for (std::size_t i = 0; i < scene.nodes().size(); ++i) {
    const auto found = T_world.find(scene.nodes()[i].name);
    ASSERT_NE(found, T_world.end()) << scene.nodes()[i].name;
    EXPECT_TRUE(found->second.isApprox(poses[i], 1e-9)) << scene.nodes()[i].name;
  }
}

TEST_F(RobotMessages, TheStateSaysWhyTheRobotStopsAndWhatToDo) {
  const auto state_now = [&] { return robot_state(robot_.robot().status(), robot_.rig()); };
  RobotState state = state_now();
  EXPECT_EQ(objection(state, {robot_.clock().now().ns, robot_.rig().joint_names(), {}}), "");
  EXPECT_EQ(state.phase.label, "ready");
  EXPECT_EQ(state.gate.label, "following");
  EXPECT_EQ(diagnostics(state).status.front().level, DiagnosticStatus::kOk);
  robot_.robot().ask(RobotRequest::emergency_stop);
  robot_.run(1s);
  state = state_now();
  EXPECT_EQ(state.phase.label, "stopped");
  EXPECT_EQ(state.reason.label, "operator's stop");
  EXPECT_EQ(state.reason.cure, "reset (r) once the way is clear");
  ASSERT_EQ(state.drives.size(), robot_.rig().joints.size());
  EXPECT_EQ(state.drives[3].name, "elbow");
  EXPECT_TRUE(state.drives[3].known);
  EXPECT_EQ(state.loop.rate_hz, 250);
  const DiagnosticArray all = diagnostics(state);
  EXPECT_EQ(objection(all), "");
  EXPECT_EQ(all.status.front().level, DiagnosticStatus::kError);
  EXPECT_EQ(all.status.size(), state.drives.size() + 2);
}

TEST(StereoFrameMessage, HasTheInstantsPosesAndJointsOfItsPair) {
  LiveFrame frame;
  frame.number = 7;
  frame.pair.left.time = RobotTime{1000};
  frame.pair.right.time = RobotTime{1500};
  frame.pair.left.bgr = frame.pair.right.bgr = cv::Mat(4, 6, CV_8UC3);
  frame.quality = "tags";
  frame.predicted_px = 0.5;
  frame.joints = {RobotTime{1000}, StateStatus::interpolated, {0.1, 0.2, NAN}, {true, false, false}};
  frame.came = RobotTime{2000};
  frame.registered = RobotTime{3000};
  PosedFrame posed;
  posed.left.T_world_camera = Pose::Identity();
  posed.left.T_world_camera.translation().x() = 2;
  posed.right.emplace().T_world_camera = Pose::Identity();
  frame.posed = posed;
  StereoFrame message = stereo_frame(frame, {"a", "b", "c"});
  EXPECT_EQ(message.number, 7u);
  EXPECT_EQ(message.left.capture_ns, 1000);
  EXPECT_EQ(message.right.capture_ns, 1500);
  EXPECT_EQ(message.left.width, 6u);
  EXPECT_TRUE(message.left.has_pose);
  EXPECT_EQ(message.left.t_world_camera.position.x, 2);
  EXPECT_EQ(message.predicted_px, 0.5);
  ASSERT_EQ(message.joints.size(), 3u);
  EXPECT_EQ(message.joints[0].status, JointSample::kKnown);
  EXPECT_EQ(message.joints[1].status, JointSample::kLastHeardOf);
  EXPECT_EQ(message.joints[1].position, 0.2);
  EXPECT_EQ(message.joints[2].status, JointSample::kNeverKnown);
  EXPECT_EQ(message.stamps.paired_ns, 2000);
  EXPECT_EQ(message.stamps.registered_ns, 3000);
  message.coding = kJpegCoding;
  message.left.data = message.right.data = {1};
  EXPECT_EQ(objection(message, {1500, {"a", "b", "c"}, {{6, 4, 6, 4}}}), "");
  EXPECT_NE(objection(message, {1499, {}, {}}), "");
}

TEST(LensesRevision, ChangesWithEitherLens) {
  const Lens lens(Lens::Parameters{LensModel::plumb_bob, 640, 480, 500, 500, 320, 240, {}});
  const Lens other(Lens::Parameters{LensModel::plumb_bob, 640, 480, 500.001, 500, 320, 240, {}});
  const std::string revision = lenses_revision({lens, lens, Pose::Identity()});
  EXPECT_EQ(revision, lenses_revision({lens, lens, Pose::Identity()}));
  EXPECT_NE(revision, lenses_revision({lens, other, Pose::Identity()}));
  EXPECT_NE(revision, lenses_revision({other, lens, Pose::Identity()}));
  const CameraInfoMessage info = camera_info(lens, "left_camera", {});
  EXPECT_EQ(objection(info), "");
  EXPECT_EQ(info.k[0], 500);
  EXPECT_EQ(info.d.size(), 5u);
}

}  // namespace
}  // namespace foresight::link::robot_messages_test
