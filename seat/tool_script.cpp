#include "seat/tool_script.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "common/error.hpp"
#include "input/sliding_jaws.hpp"
#include "prediction/grasp/hand_path.hpp"
#include "seat/ways_to_pose.hpp"
#include "sim/lab_task.hpp"

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
    to_ = step.joints && step.about.empty() ? *step.joints
                                            : kinematics_.solve(T_base_aim_, step.joints.value_or(from_)).q;
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
      const bool given_up = !there && in_step_ > lasts_ + kLongestLine;
      fell_short_ = fell_short_ || given_up;
      return there || given_up;
    }
    case ToolStep::What::gripper: {
      bool there = true;
      for (std::size_t k = 0; k < grippers_.size(); ++k) {
        double& position = position_[grippers_[k]];
        const double most = kShareOfSpeed * rig_.joints[grippers_[k]].drive.max_velocity * dt;
        position += std::clamp(step.grip[k] - position, -most, most);
        there = there && std::abs(step.grip[k] - position) < 1e-9;
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

// How a brick is taken, m.
constexpr double kOnBrick = 0.028, kLeastOnBrick = 0.01;   // of the jaws, from their tips on, beside it
constexpr double kRoom = 0.036, kLeastRoom = 0.006;        // that they open wider than it
constexpr double kSqueeze = 0.008, kLeastSqueeze = 0.004;  // that they would close further: sprung, and their pads give
constexpr double kAbove = 0.14, kIntoTray = 0.012;         // that the hand comes and goes higher, and lets go higher
constexpr double kAskew = 0.02;                            // rad that jaws may be turned off the thing's sides

struct BrickGrasp {
  SlidingJaws::Place open, closed;
  double tips = 0;  // m above the brick's bottom
};

BrickGrasp brick_grasp(const Rig& rig) {
  const SlidingJaws jaws = sliding_jaws(rig, kOnBrick);
  const std::string brick = fmt::format(", a brick is {:.3f} m wide, ", sim::kBrickSide);
  require(jaws.depth >= kLeastOnBrick, rig.name,
          fmt::format("the jaws stand {:.3f} m out of the hand, and {:.3f} m are to lie on a brick", jaws.depth,
                      kLeastOnBrick),
          "use longer jaws");
  require(jaws.widest.gap >= sim::kBrickSide + kLeastRoom, rig.name,
          fmt::format("the jaws open {:.3f} m", jaws.widest.gap) + brick +
              fmt::format("and {:.3f} m more are needed", kLeastRoom),
          "correct min and max of the gripper's joints, or use jaws that open wider");
  require(jaws.narrowest.gap <= sim::kBrickSide - kLeastSqueeze, rig.name,
          fmt::format("the jaws close to {:.3f} m", jaws.narrowest.gap) + brick +
              fmt::format("and is held by jaws that would close {:.3f} m further", kLeastSqueeze),
          "correct min and max of the gripper's joints, or use jaws that close further");
  return {jaws.at(sim::kBrickSide + kRoom), jaws.at(sim::kBrickSide - kSqueeze), sim::kBrickHeight - jaws.depth};
}

/// From where the joints stand after homing: all the way, and clear. `shape` may be null.
bool goes_well(const Rig& rig, RobotShape* shape, const std::vector<ToolStep>& steps) {
  constexpr double kLook = 0.05;  // s between two looks
  ToolScript script(rig, steps, {.pan = 0, .tilt = 0});
  const auto end = end_of_clear_way(script, home_of(rig), kLook, [&](const JointValues& joints) {
    return shape == nullptr || shape->obstructed({joints.data(), rig.joints.size()}) == nullptr;
  });
  return end && !script.fell_short();
}

InputError out_of_reach(const Rig& rig, const ArmChain& arm, const Pose& from, const Pose& to,
                        const std::string& what) {
  const Eigen::Vector3d foot = rig.T_world_robot * arm.lines().front().point;
  const double here = (from.translation() - foot).norm(), there = (to.translation() - foot).norm();
  const bool is_far = std::max(here, there) > arm.reach();
  const std::size_t joints = arm.lines().size();
  return {
      rig.name,
      fmt::format("the arm does not reach {} with its jaws pointing down, turned along a side of the thing: they are "
                  "{:.2f} and {:.2f} m from its first axis, and its last link gets {:.2f} m far",
                  what, here, there, arm.reach()),
      joints < 6 && !is_far
          ? fmt::format("use an arm of six joints or more: one of {} has its jaws turned one way wherever they are, "
                        "which may be along no side",
                        joints)
          : "correct robot.pose of the rig such that the lab's table is before it, or use a larger arm"};
}

/// From a thing at one place to another, the jaws' y turned by `turn` about the vertical.
class PickPlan {
 public:
  PickPlan(const BrickGrasp& grasp, double turn) : grasp_(grasp) {
    R_world_grip_ = (Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()) *
                     Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()))
                        .toRotationMatrix();
  }
  std::vector<ToolStep> steps(const std::string& thing, const Pose& from, const std::string& tray,
                              const Pose& to) const {
    using enum ToolStep::What;
    const auto about = [](ToolStep step, const std::string& node, const Pose& T_world_node) {
      step.about = node;
      step.T_world_about = T_world_node;
      return step;
    };
    return {{gripper, Pose::Identity(), grasp_.open.joints, 0.2},
            about({there, tool_at(from, kAbove), {}, 2}, thing, from),
            about({line, tool_at(from, 0), {}, 2.5}, thing, from),
            {gripper, Pose::Identity(), grasp_.closed.joints, 1},
            {wait, Pose::Identity(), {}, 0.5},
            {line, tool_at(from, kAbove), {}, 2},
            about({line, tool_at(to, kAbove), {}, 3}, tray, to),
            about({line, tool_at(to, kIntoTray), {}, 2}, tray, to),
            {gripper, Pose::Identity(), grasp_.open.joints, 1},
            {wait, Pose::Identity(), {}, 0.3},
            {line, tool_at(to, kAbove), {}, 2}};
  }

 private:
  Pose tool_at(const Pose& place, double above) const {
    Pose T_world_grip = Pose::Identity();
    T_world_grip.linear() = R_world_grip_;
    T_world_grip.translation() = place.translation() + Eigen::Vector3d(0, 0, grasp_.tips + above);
    return T_world_grip * grasp_.open.T_tool_grip.inverse();
  }

  const BrickGrasp& grasp_;
  Eigen::Matrix3d R_world_grip_;
};

bool reaches(const Rig& rig, const InverseKinematics& kinematics, const std::vector<ToolStep>& steps) {
  return std::ranges::all_of(steps, [&](const ToolStep& step) {
    if (step.what != ToolStep::What::there && step.what != ToolStep::What::line) return true;
    const IkAnswer answer = kinematics.solve(rig.T_world_robot.inverse() * step.T_world_tool);
    return answer.status == IkStatus::solved && answer.rotation_error < kAskew;
  });
}

/// The same, clear all the way, with other joints at the step that takes all of them at once.
std::optional<std::vector<ToolStep>> by_other_joints(const Rig& rig, RobotShape* shape,
                                                     const InverseKinematics& kinematics, std::vector<ToolStep> steps) {
  constexpr int kWays = 8;
  ToolStep& there = *std::ranges::find(steps, ToolStep::What::there, &ToolStep::what);
  const JointVector home = joints_of(home_of(rig), arm_options(rig).arm_joints);
  std::mt19937 random(1);
  for (const JointVector& q :
       ways_to_pose(kinematics, rig.T_world_robot.inverse() * there.T_world_tool, home, kWays, random)) {
    there.joints = q;
    if (goes_well(rig, shape, steps)) return steps;
  }
  return std::nullopt;
}

}  // namespace

std::optional<JointValues> end_of_clear_way(ToolScript& script, const JointValues& from, double look_s,
                                            const std::function<bool(const JointValues&)>& is_clear) {
  script.begin_at(from);
  JointValues end = from;
  bool was_clear = false;
  while (const auto next = script.step(look_s, {})) {
    end = *next;
    const bool clear_now = is_clear(end);
    if (was_clear && !clear_now) return std::nullopt;
    was_clear = clear_now;
  }
  return was_clear ? std::optional(end) : std::nullopt;
}

std::vector<ToolStep> pick_and_place(const Rig& rig, const LiveScene& scene, const std::string& thing,
                                     const std::string& tray) {
  const BrickGrasp grasp = brick_grasp(rig);
  const Pose from = place_at_rest(scene, thing), to = place_at_rest(scene, tray);
  const InverseKinematics kinematics(*arm_options(rig).arm);
  const double yaw = std::atan2(from.linear()(1, 0), from.linear()(0, 0));
  const auto shape = rig.shape();
  if (shape) shape->surround(rig.surroundings);
  std::vector<std::vector<ToolStep>> reached;
  for (int quarter = 0; quarter < 4; ++quarter) {
    std::vector<ToolStep> steps = PickPlan(grasp, yaw + quarter * std::numbers::pi / 2).steps(thing, from, tray, to);
    if (!reaches(rig, kinematics, steps)) continue;
    if (goes_well(rig, shape.get(), steps)) return steps;
    reached.push_back(std::move(steps));
  }
  for (const std::vector<ToolStep>& steps : reached)
    if (auto other = by_other_joints(rig, shape.get(), kinematics, steps)) return std::move(*other);
  if (!reached.empty()) return reached.front();  // the gate stops where it has to
  throw out_of_reach(rig, kinematics.chain(), from, to, "'" + thing + "' and '" + tray + "'");
}

}  // namespace foresight
