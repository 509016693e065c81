#include "apps/bench/seat_hand.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "input/gamepad.hpp"

namespace foresight {
namespace {

constexpr int kGamepadEach = 3;     // presses
constexpr double kLookGain = 2;     // 1/s: of how far the camera is from where it shall look
constexpr double kLookedAt = 1e-3;  // rad

/// A stick's deflection for that share of the full speed.
double deflection(double share) {
  constexpr double kDead = GamepadOptions{}.dead_zone;
  const double size = std::min(std::abs(share), 1.0);
  return size < 1e-3 ? 0 : std::copysign(kDead + (1 - kDead) * size, share);
}

}  // namespace

SeatHand::SeatHand(const Rig& rig, std::shared_ptr<const SceneModel> scene)
    : rig_(rig), driver_(rig, devices(), std::move(scene)) {
  driver_.look_within(T_world_space_);
}

std::vector<std::unique_ptr<Tracker>> SeatHand::devices() const {
  std::vector<std::unique_ptr<Tracker>> out;
  out.push_back(std::make_unique<head::HeadHands>(controllers_));
  out.push_back(std::make_unique<Gamepad>(gamepad_.index()));
  return out;
}

void SeatHand::look(const ViewPlace& place) {
  T_world_camera_ = place.T_world_camera;
  driver_.look_from(place.T_world_camera);
  driver_.scene_stands(place.scene.T_world_node);
}

Pose SeatHand::tool(const JointValues& positions) const {
  const HandOptions& hand = driver_.options();
  return hand.arm->tip_pose(joints_of(positions, hand.arm_joints));
}

void SeatHand::go_by_controller(const Pose& from, const Pose& to) {
  const Eigen::Matrix3d R_space_base = T_world_space_.linear().transpose() * rig_.T_world_robot.linear();
  T_space_hand_.translation() += R_space_base * (to.translation() - from.translation());
  const Eigen::Matrix3d turn = R_space_base * to.linear() * from.linear().transpose() * R_space_base.transpose();
  T_space_hand_.linear() = Eigen::Quaterniond(turn * T_space_hand_.linear()).normalized().toRotationMatrix();
}

void SeatHand::go_by_gamepad(const Pose& from, const Pose& to, double dt) {
  const Eigen::Matrix3d R_operator_base =
      (T_world_camera_.linear() * R_view_operator()).transpose() * rig_.T_world_robot.linear();
  const Eigen::Vector3d share =
      R_operator_base * (to.translation() - from.translation()) / (dt * RateHandOptions{}.speed);
  sticks_.left_x = -deflection(share.y());
  sticks_.left_y = -deflection(share.x());
  sticks_.right_y = -deflection(share.z());
}

double SeatHand::look_rate(const std::optional<std::size_t>& joint, const SeatWish& meant) const {
  if (!joint || !meant.deadman || !sent_.deadman) return 0;
  const double off = meant.position[*joint] - sent_.position[*joint];
  const double speed = driver_.options().look_speed * rig_.joints[*joint].drive.max_velocity;
  return std::abs(off) < kLookedAt ? 0 : std::clamp(kLookGain * off / speed, -1.0, 1.0);
}

TrackerState SeatHand::controller(const SeatView& view, const SeatWish& meant) const {
  const HandOptions& hand = driver_.options();
  TrackerState out;
  out.connected = out.tracked = true;
  out.time = view.now;
  out.T_space_hand = T_space_hand_;
  out.T_space_head = Pose::Identity();
  const bool held = meant.deadman && !at_gamepad_;
  out.buttons.set(TrackerButton::deadman, held);
  out.buttons.set(TrackerButton::clutch, held);
  out.pan_rate = look_rate(hand.pan, meant);
  out.tilt_rate = (hand.tilt_looks_down ? -1 : 1) * look_rate(hand.tilt, meant);
  switch (fault_) {
    case ControllerFault::not_seen: out.tracked = false; break;
    case ControllerFault::late: out.time = view.now - std::chrono::seconds(1); break;
    case ControllerFault::no_number:
      out.T_space_hand.translation().x() = std::numeric_limits<double>::quiet_NaN();
      break;
    case ControllerFault::other_clock: out.time = view.now + std::chrono::hours(1); break;
    default: break;
  }
  return out;
}

SeatWish SeatHand::pass_on(const SeatView& view, const SeatWish& meant) {
  if (meant.request != LineRequest::none) driver_.ask(meant.request);
  const double dt = last_ ? to_seconds(view.now - *last_) : 0;
  last_ = view.now;
  const bool held = T_base_tool_.has_value();
  if (meant.deadman && !held) at_gamepad_ = ++presses_ % kGamepadEach == 0;
  sticks_ = {};
  if (meant.deadman) {
    const Pose to = tool(meant.position);
    if (held && !at_gamepad_) go_by_controller(*T_base_tool_, to);
    if (held && at_gamepad_ && dt > 0) go_by_gamepad(*T_base_tool_, to, dt);
    T_base_tool_ = to;
  } else {
    T_base_tool_.reset();
  }
  sticks_.right_shoulder = meant.deadman && at_gamepad_;
  gamepad_.move(sticks_);
  if (fault_ == ControllerFault::off)
    controllers_->gone("the controller is off", "switch it on; let go, and press again");
  else if (fault_ != ControllerFault::frozen)
    controllers_->hands[1].say(controller(view, meant));
  driver_.take({}, view.now);
  return sent_ = driver_.tick(view);
}

}  // namespace foresight
