#include "seat/tool_script.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/error.hpp"
#include "prediction/grasp/hand_path.hpp"

namespace foresight {
namespace {

constexpr double kShareOfSpeed = 0.5;  // of the joints' velocities that a script asks for
constexpr double kPeak = 1.875;        // of minimum jerk, over its mean
constexpr double kThere = 1e-3;        // m and rad: a line has ended
constexpr double kLongestLine = 10;    // s more than asked for: then it goes on with the next

std::vector<std::size_t> of_group(const Rig& rig, JointGroup group) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < rig.joints.size(); ++i)
    if (rig.joints[i].group == group) out.push_back(i);
  return out;
}

}  // namespace

JointValues home_of(const Rig& rig) {
  JointValues out{};
  for (std::size_t i = 0; i < rig.joints.size(); ++i) {
    const DriveConfig& drive = rig.joints[i].drive;
    out[i] = std::clamp(drive.offset, drive.min_position, drive.max_position);
  }
  return out;
}

ToolScript::ToolScript(const Rig& rig, std::vector<ToolStep> steps, const HeadSway& sway)
    : ToolScript(rig, arm_options(rig), std::move(steps), sway) {}

ToolScript::ToolScript(const Rig& rig, const HandOptions& hand, std::vector<ToolStep> steps, const HeadSway& sway)
    : rig_(rig),
      kinematics_(*hand.arm),
      arm_(hand.arm_joints),
      grippers_(of_group(rig, JointGroup::gripper)),
      head_(of_group(rig, JointGroup::pan_tilt)),
      steps_(std::move(steps)),
      sway_(sway),
      T_world_base_(rig.T_world_robot) {
  for (const ToolStep& step : steps_) {
    if (step.what != ToolStep::What::there && step.what != ToolStep::What::line) continue;
    if (step.what == ToolStep::What::there && step.joints) continue;
    const IkAnswer answer = kinematics_.solve(T_world_base_.inverse() * step.T_world_tool);
    if (answer.status != IkStatus::solved)
      throw InputError("the script", "asks for a pose that the arm cannot reach", "move it nearer");
  }
}

JointVector ToolScript::arm() const {
  return joints_of(position_, arm_);
}

void ToolScript::set_arm(const JointVector& q) {
  for (std::size_t i = 0; i < arm_.size(); ++i) position_[arm_[i]] = q[static_cast<Eigen::Index>(i)];
}

void ToolScript::begin_at(const JointValues& begin) {
  position_ = begin;
  if (!began_) head_begin_ = begin;
  began_ = true;
  begin_step();
}

/// By what the node has gone along its ground and turned about the vertical; heights and tilts of what is seen are
/// noise.
Pose ToolScript::aim_of(const ToolStep& step) const {
  const auto seen = sees_ && !step.about.empty() ? sees_(step.about) : std::nullopt;
  if (!seen) return T_world_base_.inverse() * step.T_world_tool;
  const auto yaw = [](const Pose& pose) { return std::atan2(pose.linear()(1, 0), pose.linear()(0, 0)); };
  Eigen::Vector3d to = seen->translation();
  to.z() = step.T_world_about.translation().z();
  const Pose T_world_aim = Eigen::Translation3d(to) *
                           Eigen::AngleAxisd(yaw(*seen) - yaw(step.T_world_about), Eigen::Vector3d::UnitZ()) *
                           Eigen::Translation3d(-step.T_world_about.translation()) * step.T_world_tool;
  const Pose T_base_aim = T_world_base_.inverse() * T_world_aim;
  const bool reached = kinematics_.solve(T_base_aim, arm()).status == IkStatus::solved;
  return reached ? T_base_aim : T_world_base_.inverse() * step.T_world_tool;
}

void ToolScript::begin_step() {
  in_step_ = 0;
  follower_.reset();
  if (at_ >= steps_.size()) return;
  const ToolStep& step = steps_[at_];
  lasts_ = step.seconds;
  T_base_aim_ = aim_of(step);
  if (step.what == ToolStep::What::there) {
    from_ = arm();
    to_ = step.joints ? *step.joints : kinematics_.solve(T_base_aim_, from_).q;
    for (std::size_t i = 0; i < arm_.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      const double speed = kShareOfSpeed * rig_.joints[arm_[i]].drive.max_velocity;
      lasts_ = std::max(lasts_, kPeak * std::abs(to_[k] - from_[k]) / speed);
    }
  } else if (step.what == ToolStep::What::line) {
    follower_.emplace(kinematics_, arm());
    line_from_ = follower_->hand();
  }
}

bool ToolScript::advance(const ToolStep& step, double dt) {
  in_step_ += dt;
  const double share = lasts_ > 0 ? minimum_jerk(std::clamp(in_step_ / lasts_, 0.0, 1.0)) : 1;
  switch (step.what) {
    case ToolStep::What::there: set_arm(from_ + share * (to_ - from_)); break;
    case ToolStep::What::line: {
      const Pose& to = T_base_aim_;
      const FollowStep made = follower_->step(pose_between(line_from_, to, share), dt);
      set_arm(made.q);
      const bool there = (made.T_base_tip.translation() - to.translation()).norm() < kThere && share == 1;
      return there || in_step_ > lasts_ + kLongestLine;
    }
    case ToolStep::What::gripper: {
      bool there = true;
      for (const std::size_t i : grippers_) {
        const double most = kShareOfSpeed * rig_.joints[i].drive.max_velocity * dt;
        position_[i] += std::clamp(step.opening - position_[i], -most, most);
        there = there && std::abs(step.opening - position_[i]) < 1e-9;
      }
      return there && in_step_ >= lasts_;
    }
    case ToolStep::What::wait: break;
  }
  return in_step_ >= lasts_;
}

void ToolScript::sway(double dt) {
  swayed_ += dt;
  constexpr double kTurns = 3;  // s
  const double share = minimum_jerk(std::clamp(swayed_ / kTurns, 0.0, 1.0));
  const double amplitudes[] = {sway_.pan, sway_.tilt}, periods[] = {sway_.pan_s, sway_.tilt_s};
  const std::optional<double> middles[] = {sway_.middle_pan, sway_.middle_tilt};
  for (std::size_t k = 0; k < std::min<std::size_t>(2, head_.size()); ++k) {
    const DriveConfig& drive = rig_.joints[head_[k]].drive;
    const double first = head_begin_[head_[k]], middle = std::lerp(first, middles[k].value_or(first), share);
    const double wanted = middle + amplitudes[k] * std::sin(2 * std::numbers::pi * swayed_ / periods[k]);
    position_[head_[k]] = std::clamp(wanted, drive.min_position, drive.max_position);
  }
}

std::optional<JointValues> ToolScript::step(double dt, const PredictedRobot&) {
  if (at_ >= steps_.size()) return std::nullopt;
  sway(dt);
  if (advance(steps_[at_], dt)) {
    ++at_;
    begin_step();
  }
  return position_;
}

Pose place_at_rest(const LiveScene& scene, const std::string& node) {
  const auto& nodes = scene.model()->nodes();
  const auto found = std::ranges::find(nodes, node, &Node::name);
  if (found == nodes.end()) throw InputError("the scene", "has no '" + node + "'", "operate the mock lab with physics");
  const JointPositions rest = [](std::string_view) { return std::nullopt; };
  const SceneState state = scene.state_at({}, rest, StateStatus::predicted);
  return state.T_world_node[static_cast<std::size_t>(found - nodes.begin())];
}

namespace {

/// From where the joints stand after homing.
bool stays_clear(const Rig& rig, RobotShape& shape, const std::vector<ToolStep>& steps) {
  constexpr double kLook = 0.05;  // s between two looks
  ToolScript script(rig, steps, {.pan = 0, .tilt = 0});
  script.begin_at(home_of(rig));
  while (const auto at = script.step(kLook, {}))
    if (shape.obstructed({at->data(), rig.joints.size()}) != nullptr) return false;
  return true;
}

}  // namespace

std::vector<ToolStep> pick_and_place(const Rig& rig, const LiveScene& scene, const std::string& thing,
                                     const std::string& tray) {
  constexpr double kTips = 0.15, kGrasp = 0.037;      // m: finger tips along the tool's z; above the thing's bottom
  constexpr double kOpen = 0.038, kClosed = 0.016;    // m, of the jaws' joint
  constexpr double kAbove = 0.14, kIntoTray = 0.012;  // m
  constexpr double kAskew = 0.02;                     // rad that jaws may be turned off the thing's sides
  const Pose from = place_at_rest(scene, thing), to = place_at_rest(scene, tray);
  const HandOptions hand = arm_options(rig);
  const InverseKinematics kinematics(*hand.arm);
  const double yaw = std::atan2(from.linear()(1, 0), from.linear()(0, 0));
  const auto shape = rig.shape();
  if (shape) shape->surround(rig.surroundings);
  std::optional<std::vector<ToolStep>> in_the_way;  // of itself, or of the table
  for (int quarter = 0; quarter < 4; ++quarter) {
    const double turn = yaw + quarter * std::numbers::pi / 2;
    const auto at = [&](const Pose& place, double above) {
      Pose out = Pose::Identity();
      out.linear() = (Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()) *
                      Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()))
                         .toRotationMatrix();
      out.translation() = place.translation() + Eigen::Vector3d(0, 0, kGrasp + kTips + above);
      return out;
    };
    using enum ToolStep::What;
    const auto about = [](ToolStep step, const std::string& node, const Pose& T_world_node) {
      step.about = node;
      step.T_world_about = T_world_node;
      return step;
    };
    std::vector<ToolStep> steps{{gripper, Pose::Identity(), kOpen, 0.2},
                                about({there, at(from, kAbove), 0, 2}, thing, from),
                                about({line, at(from, 0), 0, 2.5}, thing, from),
                                {gripper, Pose::Identity(), kClosed, 1},
                                {wait, Pose::Identity(), 0, 0.5},
                                {line, at(from, kAbove), 0, 2},
                                about({line, at(to, kAbove), 0, 3}, tray, to),
                                about({line, at(to, kIntoTray), 0, 2}, tray, to),
                                {gripper, Pose::Identity(), kOpen, 1},
                                {wait, Pose::Identity(), 0, 0.3},
                                {line, at(to, kAbove), 0, 2}};
    const bool reached = std::ranges::all_of(steps, [&](const ToolStep& step) {
      if (step.what != there && step.what != line) return true;
      const IkAnswer answer = kinematics.solve(rig.T_world_robot.inverse() * step.T_world_tool);
      return answer.status == IkStatus::solved && answer.rotation_error < kAskew;
    });
    if (!reached) continue;
    if (!shape || stays_clear(rig, *shape, steps)) return steps;
    if (!in_the_way) in_the_way = std::move(steps);
  }
  if (in_the_way) return std::move(*in_the_way);  // the gate stops where it has to
  throw InputError("the script", "the arm does not reach '" + thing + "' or '" + tray + "' from above",
                   "use the lab's own arm");
}

}  // namespace foresight
