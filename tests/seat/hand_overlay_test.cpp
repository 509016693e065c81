// What is drawn of the hand, over a view of the lab.
#include "seat/hand_overlay.hpp"

#include "display/scene_overlay.hpp"
#include "input/hand_of_rig.hpp"
#include "seat/hud.hpp"
#include "seat/predicted_place.hpp"
#include "sim/pan_tilt_head.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/headless_test.hpp"

namespace foresight::hand_overlay_test {
namespace {

using Eigen::Vector3d;

/// A hand 12 cm below the tool, which a table stops.
struct World {
  World() : rig(read_rig(source_folder() / "configs" / "minerva.yaml")), hand(hand_options(rig)), overlay(rig, hand) {
    // Above the middle of the table, pointing down.
    Pose T_world_tool = Pose::Identity();
    T_world_tool.translation() = Vector3d(-0.05, 0.14, 0.22);
    T_world_tool.linear() = Eigen::AngleAxisd(M_PI, Vector3d::UnitX()).toRotationMatrix();
    const JointVector arm = InverseKinematics(*hand.arm).solve(rig.T_world_robot.inverse() * T_world_tool).q;
    for (std::size_t i = 0; i < 7; ++i) stands[i] = arm[static_cast<Eigen::Index>(i)];
    stands[7] = 0.03;
  }
  Pose tool(const JointValues& q) const {
    JointVector arm(7);
    for (std::size_t i = 0; i < 7; ++i) arm[static_cast<Eigen::Index>(i)] = q[i];
    return rig.T_world_robot * hand.arm->tip_pose(arm);
  }
  HandSight pressing() const {
    HandSight out;
    out.phase = HandPhase::driving;
    out.joints = 10;
    out.positions = stands;
    out.T_world_tool = tool(stands);
    out.T_world_hand = out.T_world_tool;
    out.T_world_hand->translation().z() -= 0.12;
    out.touch.known = true;
    out.touch.ghost.shown = true;
    out.touch.ghost.reason = GhostReason::contact;
    out.touch.ghost.words = "finger_left touches mat";
    const Vector3d tip = out.T_world_tool * Vector3d(0, 0.02, 0.15);
    out.touch.near = {{"finger_left", "mat", 0.001, tip, tip - Vector3d(0, 0, 0.001)},
                      {"finger_right", "brick_red", 0.014, tip + Vector3d(0.02, 0, 0), tip + Vector3d(0.034, 0, 0)}};
    return out;
  }
  /// The shoulder turns, half a second of it under way.
  std::vector<PredictedRobot> turning() const {
    std::vector<PredictedRobot> out(16);
    for (std::size_t i = 0; i < out.size(); ++i) {
      out[i].time = RobotTime{static_cast<std::int64_t>(i) * 33'000'000};
      out[i].status = StateStatus::predicted;
      out[i].joints = 10;
      out[i].position = stands;
      out[i].position[0] -= 0.3 * (1 - static_cast<double>(i) / 15);
    }
    return out;
  }
  Rig rig;
  HandOptions hand;
  HandOverlay overlay;
  JointValues stands{};
};

bool any_has(const std::vector<WorldLabel>& labels, const std::string& words) {
  return std::ranges::any_of(labels, [&](const WorldLabel& l) { return l.words.find(words) != std::string::npos; });
}

TEST(HandOverlay, GhostStandsWhereTheHandIsWithItsReason) {
  World world;
  const HandSight sight = world.pressing();
  const HandPicture picture = world.overlay.draw(sight, {});
  ASSERT_FALSE(picture.labels.empty());
  EXPECT_EQ(picture.labels[0].words, "finger_left touches mat");
  EXPECT_LT((picture.labels[0].at - sight.T_world_hand->translation()).norm(), 1e-9);
  Eigen::AlignedBox3f dashed;
  for (const OverlayStroke& stroke : picture.lines.strokes())
    if (stroke.style.dash > 0.01f) dashed.extend(stroke.a).extend(stroke.b);
  // The gripper's palm and fingers, turned upside down: from the hand to the tips.
  EXPECT_NEAR(dashed.sizes().maxCoeff(), 0.17, 0.06);
  EXPECT_TRUE(dashed.contains(sight.T_world_hand->translation().cast<float>()));
  ASSERT_EQ(picture.labels.size(), 2u) << "the same is not said twice";
  EXPECT_EQ(picture.labels[1].words, "14 mm to brick_red");
}

TEST(HandOverlay, NothingOfTheHandIsDrawnWhileItDoesNotDrive) {
  World world;
  HandSight sight = world.pressing();
  sight.phase = HandPhase::released;
  EXPECT_TRUE(world.overlay.draw(sight, {}).lines.empty());
  sight = world.pressing();
  sight.touch.ghost.shown = false;
  EXPECT_FALSE(any_has(world.overlay.draw(sight, {}).labels, "your hand"));
}

TEST(HandOverlay, WhatIsUnderWayGoesFromTheKnownToolToTheShown) {
  World world;
  const auto under_way = world.turning();
  const HandPicture picture = world.overlay.draw({}, under_way);
  ASSERT_EQ(picture.labels.size(), 1u);
  EXPECT_EQ(picture.labels[0].words, "known; sent since: 495 ms");
  EXPECT_LT((picture.labels[0].at - world.tool(under_way[0].position).translation()).norm(), 1e-9);
  int dots = 0;
  for (const OverlayStroke& stroke : picture.lines.strokes()) dots += stroke.a == stroke.b;
  EXPECT_EQ(dots, 16);
  auto still = under_way;
  for (PredictedRobot& robot : still) robot.position = world.stands;
  EXPECT_TRUE(world.overlay.draw({}, still).lines.empty()) << "a robot that stands has nothing under way";
}

TEST(HandOverlay, AJointNearItsLimitGetsADial) {
  World world;
  auto at_limit = world.turning();
  for (PredictedRobot& robot : at_limit) robot.position[3] = 0.97 * world.hand.arm->joints()[3].upper;
  const HandPicture picture = world.overlay.draw({}, {at_limit.back()});
  ASSERT_EQ(picture.labels.size(), 1u);
  EXPECT_EQ(picture.labels[0].words, "joint 4 (elbow) at 97 % of its range");
  EXPECT_FALSE(picture.lines.empty());
}

class HandOverlayPicture : public HeadlessTest {};

// All of it over the lab as the head sees it: the ghost's hue is where its lines are, words keep out of each other's
// way.
TEST_F(HandOverlayPicture, IsSeenThroughTheHeadsLens) {
  World world;
  const LiveScene scene = live_scene_of(world.rig, true, std::nullopt);
  const Lens& lens = scene.lenses()->left;
  const auto under_way = world.turning();
  JointValues joints = world.stands;
  joints[8] = sim::kHeadAtTable.pan;
  joints[9] = sim::kHeadAtTable.tilt;
  const JointPositions by_name = positions_of(world.rig, joints);
  const JointPositions shafts = [&](std::string_view name) { return by_name(shaft_name(world.rig, name)); };
  const Pose T_world_camera = scene.T_world_left(shafts);
  const gl::FaceImages faces(gl::faces_for(lens, 2), true);
  gl::RasterPass(std::make_shared<gl::SceneBuffers>(*scene.model()), true)(
      T_world_camera, scene.state_at({}, shafts, StateStatus::predicted), faces);

  constexpr int kWidth = 960, kHeight = 720;
  gl::Texture texture(GL_RGBA8, kWidth, kHeight, 0, 1, "seat");
  const TextureTarget target(texture.name(), kWidth, kHeight, -1, false);  // as a window
  fill(target.whole(), 0.3f, 0.3f, 0.3f);
  const HandPicture picture = world.overlay.draw(world.pressing(), under_way);
  SceneOverlay overlay(lens);
  overlay.draw(picture.lines, T_world_camera, faces, target.whole());
  HudContent content;
  for (const WorldLabel& label : picture.labels)
    if (const auto at = seen_at(label.at, lens, T_world_camera, target.whole(), kHeight))
      content.labels.push_back({at->x(), at->y(), label.words, label.urgency});
  EXPECT_GE(content.labels.size(), 3u);
  cv::Mat drawn(kHeight, kWidth, CV_8UC4);
  const auto read = [&] {
    glGetTextureImage(texture.name(), 0, GL_BGRA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(drawn.total() * 4),
                      drawn.data);
    cv::flip(drawn, drawn, 0);
  };
  read();
  cv::Mat orange, blue;
  cv::inRange(drawn, cv::Scalar(0, 100, 200, 0), cv::Scalar(90, 200, 255, 255), orange);
  cv::inRange(drawn, cv::Scalar(200, 150, 0, 0), cv::Scalar(255, 255, 130, 255), blue);
  EXPECT_GT(cv::countNonZero(orange), 300) << "the ghost";
  // Of a path between links, most of which the wrist hides, what is not: its hidden dots are dimmer than this range.
  EXPECT_GT(cv::countNonZero(blue), 60) << "what is under way";
  const cv::Mat before = drawn.clone();
  Hud().draw(content, target.whole());
  read();
  EXPECT_GT(cv::norm(before, drawn, cv::NORM_L1), 1e5) << "words beside their places";
}

}  // namespace
}  // namespace foresight::hand_overlay_test
