// How uncertain joints are, in pixels of what is drawn.
#include "seat/place_doubt.hpp"

#include "tests/support/folders.hpp"

namespace foresight::place_doubt_test {
namespace {

Rig minerva() {
  return read_rig(source_folder() / "configs" / "minerva.yaml");
}

/// Built once: that takes longer than all else here.
std::shared_ptr<const LiveScene> lab() {
  static const auto built = std::make_shared<const LiveScene>(live_scene_of(minerva(), true, std::nullopt));
  return built;
}

class PlaceDoubt : public testing::Test {
 protected:
  PlaceDoubt() {
    robot_.status = StateStatus::predicted;
    robot_.joints = rig_.joints.size();
    robot_.time = {1'000'000'000};
  }
  std::size_t joint_of(JointGroup group) const {
    const auto found = std::ranges::find(rig_.joints, group, &RigJoint::group);
    return static_cast<std::size_t>(found - rig_.joints.begin());
  }
  std::size_t shoulder() const { return joint_of(JointGroup::arm) + 1; }  // the base's turns parts about themselves
  std::vector<double> px(const std::optional<ViewPlace>& before = std::nullopt) const {
    return node_doubt_px(places_, robot_, lens_, middles_, before);
  }
  std::size_t count_off(bool moving, const std::vector<double>& px) const {
    std::size_t out = 0;
    for (std::size_t i = 0; i < px.size(); ++i) out += scene_->model()->nodes()[i].may_move == moving && px[i] > 0.1;
    return out;
  }

  Rig rig_ = minerva();
  std::shared_ptr<const LiveScene> scene_ = lab();
  PredictedPlaces places_{rig_, scene_};
  Lens lens_ = scene_->lenses()->left;
  std::vector<Eigen::Vector3d> middles_ = node_middles(*scene_->model());
  PredictedRobot robot_;
};

TEST_F(PlaceDoubt, NothingIsOffWhereAllIsKnown) {
  for (const double off : px()) EXPECT_EQ(off, 0);
}

TEST_F(PlaceDoubt, TheHeadsMovesTheWholeView) {
  robot_.sigma[joint_of(JointGroup::pan_tilt)] = 0.02;
  const auto off = px();
  // Half of sigma counts; on the optical axis, that is its focal length in pixels.
  const double least = 0.4 * 0.02 * lens_.parameters().fx;
  EXPECT_GT(std::ranges::count_if(off, [&](double one) { return one > least; }), std::ssize(off) * 3 / 4);
}

// As once nothing is heard of a robot that moved.
TEST_F(PlaceDoubt, WhatTheJointsAreNotSureOfMayBeAnywhere) {
  const double px_of_half = 0.5 * lens_.parameters().fx;
  robot_.sigma[joint_of(JointGroup::pan_tilt)] = 1.5 * kNotKnownPx / px_of_half;
  const auto unsure = px();
  EXPECT_GT(std::ranges::count(unsure, kAnywherePx), std::ssize(unsure) * 3 / 4);
  robot_.sigma[joint_of(JointGroup::pan_tilt)] = 0.3 * kNotKnownPx / px_of_half;
  const auto sure = px();
  EXPECT_LT(std::ranges::count(sure, kAnywherePx), std::ssize(sure) / 4) << "but for what is close to the camera";
}

TEST_F(PlaceDoubt, TheArmsMovesTheArmAlone) {
  robot_.sigma[shoulder()] = 0.02;
  const auto off = px();
  EXPECT_EQ(count_off(false, off), 0u);
  EXPECT_GT(count_off(true, off), 3u);
}

TEST_F(PlaceDoubt, WhatMovesFastIsOffByMore) {
  ViewPlace before = places_.place(robot_);
  before.scene.time = robot_.time - std::chrono::milliseconds(100);
  robot_.position[shoulder()] += 0.1;
  const auto slow = px(before);
  EXPECT_EQ(count_off(false, slow), 0u) << "what stands is where it was";
  before.scene.time = robot_.time - std::chrono::milliseconds(50);
  const auto fast = px(before);
  EXPECT_GT(count_off(true, fast), 3u);
  for (std::size_t i = 0; i < fast.size(); ++i) EXPECT_NEAR(fast[i], 2 * slow[i], 1e-6);
}

TEST_F(PlaceDoubt, NothingIsKnownOfARobotThatIsInvalid) {
  robot_.status = StateStatus::invalid;
  for (const double off : px()) EXPECT_EQ(off, kAnywherePx);
  robot_.status = StateStatus::predicted;
  robot_.sigma[joint_of(JointGroup::pan_tilt)] = std::numeric_limits<double>::infinity();
  for (const double off : px()) EXPECT_TRUE(std::isfinite(off));
}

}  // namespace
}  // namespace foresight::place_doubt_test
