#include "seat/tour.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <random>
#include <span>
#include <tuple>

#include "common/error.hpp"
#include "input/hand_of_rig.hpp"

namespace foresight {
namespace {

constexpr int kTries = 2000;
constexpr std::size_t kFewest = 5;                   // poses that make a tour; with fewer, other ways are tried
constexpr double kTourNear = 0.35, kTourFar = 0.75;  // of the arm's reach, from its foot
// Of the arm's reach, from its first axis on, the way that its base stands: over what lies about the lab's own arm,
// from 0.30 to 0.55 m above its table.
constexpr double kTourLow = 0.10 / 0.89, kTourHigh = 0.35 / 0.89;
constexpr double kUnderLow = 0.75, kUnderHigh = 0.35;  // the same below an arm that hangs
constexpr double kHangs = 0.3;                         // of its reach: so far below its first axis is its tool midway
constexpr double kTourRoom = 0.01 / 0.89;              // beyond the rig's clearance, of the reach, too
constexpr double kNearer = 1e-6;                       // m
constexpr double kEndOfRange = 0.05;                   // of a joint's range, that a tour of joints leaves at both ends
constexpr double kLook = 0.02;                         // s between two looks at where the arm is under way
constexpr int kProbes = 300;                           // positions that tell what never comes nearer than at home

class TourPlan {
 public:
  TourPlan(const Rig& rig, unsigned seed)
      : rig_(rig),
        hand_(arm_options(rig)),
        kinematics_(*hand_.arm),
        shape_(rig.shape()),
        random_(seed),
        at_(home_of(rig)) {
    if (shape_) leave_room(kTourRoom * chain().reach());
    look_about();
  }
  std::vector<ToolStep> with_tool_down(int count);
  std::vector<ToolStep> of_joints(int count);
  /// All joints in the middle of where a tour goes, or on one.
  std::optional<JointValues> start();
  std::span<const std::size_t> arm_joints() const { return hand_.arm_joints; }
  InputError nothing() const;

 private:
  const ArmChain& chain() const { return kinematics_.chain(); }
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  void leave_room(double room);
  void look_about();
  Pose tool_down(double yaw, double distance, double height, double turn) const;
  Pose tool_down_anywhere();
  JointVector any_joints();
  void look_at(const JointVector& q);
  bool clear(const JointVector& q);
  bool clear_all_the_way(const ToolStep& step);

  const Rig& rig_;
  HandOptions hand_;
  InverseKinematics kinematics_;
  std::unique_ptr<RobotShape> shape_;
  std::vector<double> margins_, least_margins_;  // of its couples
  std::mt19937 random_;
  double ahead_ = 0;                        // rad about the vertical, where the arm looks
  double low_ = 0, high_ = 0;               // m above the world's origin
  JointValues at_;                          // of all joints, where the tour has come to
  int reached_ = 0;                         // of the poses with the tool down
  const char* in_the_way_ = nullptr;        // of the joints that were looked at last
  const char* in_the_way_there_ = nullptr;  // of the first tour's poses
};

void TourPlan::look_about() {
  const Pose& T_world_base = rig_.T_world_robot;
  const double reach = chain().reach();
  const ArmLine& first = chain().lines().front();
  const double foot = (T_world_base * first.point).z();
  const double tool = (T_world_base * chain().tip_pose(chain().middle())).translation().z();
  const bool turned_over = !first.slides && (T_world_base.linear() * first.axis).z() < -0.5;
  const bool hangs = tool < foot - kHangs * reach || (turned_over && tool < foot + kHangs * reach);
  std::tie(low_, high_) = hangs ? std::pair{foot - kUnderLow * reach, foot - kUnderHigh * reach}
                                : std::pair{foot + kTourLow * reach, foot + kTourHigh * reach};
  // Its base's x; of a base that is mounted on a wall such that x points up or down, the way out of the wall.
  Eigen::Vector3d ahead = T_world_base.linear() * Eigen::Vector3d::UnitX();
  if (ahead.head<2>().norm() < 0.5) ahead = T_world_base.linear() * Eigen::Vector3d::UnitZ();
  ahead_ = std::atan2(ahead.y(), ahead.x());
}

// The tool's z points down. `distance`: of the arm's reach, from its foot.
Pose TourPlan::tool_down(double yaw, double distance, double height, double turn) const {
  Pose pose = Pose::Identity();
  const double out = distance * chain().reach();
  const Eigen::Vector3d foot = rig_.T_world_robot.translation();
  pose.translation() =
      Eigen::Vector3d(foot.x() + out * std::cos(ahead_ + yaw), foot.y() + out * std::sin(ahead_ + yaw), height);
  pose.linear() = (Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()))
                      .toRotationMatrix();
  return pose;
}

// Before the arm, at heights where things stand.
Pose TourPlan::tool_down_anywhere() {
  const double yaw = uniform(-0.9, 0.9), distance = uniform(kTourNear, kTourFar), height = uniform(low_, high_);
  return tool_down(yaw, distance, height, uniform(-1.5, 1.5));
}

/// Beyond the rig's clearance. What cannot come nearer than it is at home, as a floor and a link that turns about the
/// vertical over it, has no room to lose.
void TourPlan::leave_room(double room) {
  Surroundings wide = rig_.surroundings;
  wide.clearance += room;
  shape_->surround(wide);
  margins_.resize(shape_->couples());
  look_at(joints_of({at_.data(), rig_.joints.size()}, hand_.arm_joints));
  const std::vector<double> at_home = margins_;
  std::vector<double> nearest = at_home;
  const std::mt19937 unused = random_;
  for (int i = 0; i < kProbes; ++i) {
    look_at(any_joints());
    std::ranges::transform(nearest, margins_, nearest.begin(), [](double a, double b) { return std::min(a, b); });
  }
  random_ = unused;
  for (std::size_t i = 0; i < nearest.size(); ++i)
    least_margins_.push_back(nearest[i] < at_home[i] - kNearer ? 0 : -room);
}

/// Into margins_.
void TourPlan::look_at(const JointVector& q) {
  JointValues all = at_;
  for (std::size_t i = 0; i < hand_.arm_joints.size(); ++i) all[hand_.arm_joints[i]] = q[static_cast<Eigen::Index>(i)];
  shape_->margins({all.data(), rig_.joints.size()}, margins_);
}

bool TourPlan::clear(const JointVector& q) {
  if (!shape_) return true;
  look_at(q);
  for (std::size_t i = 0; i < margins_.size(); ++i)
    if (margins_[i] < least_margins_[i]) {
      in_the_way_ = shape_->message(i);
      return false;
    }
  return true;
}

/// From where the tour has come to; then it has come to the step's end. Where that is too close to something, it may
/// part.
bool TourPlan::clear_all_the_way(const ToolStep& step) {
  ToolScript script(rig_, {step}, {.pan = 0, .tilt = 0});
  script.begin_at(at_);
  JointValues end = at_;
  bool was_clear = false;
  while (const auto next = script.step(kLook, {})) {
    end = *next;
    const bool is_clear = clear(joints_of({end.data(), rig_.joints.size()}, hand_.arm_joints));
    if (was_clear && !is_clear) return false;
    was_clear = is_clear;
  }
  if (was_clear) at_ = end;
  return was_clear;
}

std::vector<ToolStep> TourPlan::with_tool_down(int count) {
  std::vector<ToolStep> out;
  for (int tries = 0; tries < kTries && static_cast<int>(out.size()) < count; ++tries) {
    const Pose pose = tool_down_anywhere();
    const IkAnswer answer = kinematics_.solve(rig_.T_world_robot.inverse() * pose);
    if (answer.status != IkStatus::solved) continue;
    ++reached_;
    const auto what = out.size() % 2 == 0 ? ToolStep::What::there : ToolStep::What::line;
    // Few joints hold the tool there as they can, and are asked for no more.
    const Pose held = kinematics_.position_first() ? rig_.T_world_robot * answer.T_base_tip : pose;
    const ToolStep step{what, held, {}, what == ToolStep::What::line ? uniform(2.0, 4.0) : 1.5};
    if (clear(answer.q) && clear_all_the_way(step))
      out.push_back(step);
    else
      in_the_way_there_ = in_the_way_;
  }
  return out;
}

JointVector TourPlan::any_joints() {
  JointVector q = chain().middle();
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const double low = std::max(chain().lower()[i], q[i] - std::numbers::pi);
    const double high = std::min(chain().upper()[i], q[i] + std::numbers::pi);
    const double end = kEndOfRange * (high - low);
    q[i] = uniform(low + end, high - end);
  }
  return q;
}

std::vector<ToolStep> TourPlan::of_joints(int count) {
  std::vector<ToolStep> out;
  for (int tries = 0; tries < kTries && static_cast<int>(out.size()) < count; ++tries) {
    ToolStep step{ToolStep::What::there, Pose::Identity(), {}, 1.5};
    step.joints = any_joints();
    step.T_world_tool = rig_.T_world_robot * chain().tip_pose(*step.joints);
    if (clear(*step.joints) && clear_all_the_way(step)) out.push_back(step);
  }
  return out;
}

std::optional<JointValues> TourPlan::start() {
  constexpr int kFew = 50;  // who waits for a window does not wait for a place that is hard to find
  for (int tries = 0; tries < kFew; ++tries) {
    const Pose pose =
        tries == 0 ? tool_down(0, 0.5 * (kTourNear + kTourFar), 0.5 * (low_ + high_), ahead_) : tool_down_anywhere();
    const IkAnswer answer = kinematics_.solve(rig_.T_world_robot.inverse() * pose);
    if (answer.status != IkStatus::solved || !clear(answer.q)) continue;
    ToolStep step{ToolStep::What::there, rig_.T_world_robot * answer.T_base_tip, {}, 1.5};
    step.joints = answer.q;
    if (clear_all_the_way(step)) return at_;
  }
  return of_joints(1).empty() ? std::nullopt : std::optional(at_);
}

InputError TourPlan::nothing() const {
  const std::string where =
      fmt::format("of the tour's poses, {:.2f} to {:.2f} m above the world's origin, tool down", low_, high_);
  const char* const by_hand = ", or operate it by hand, without --scripted";
  if (in_the_way_there_ != nullptr)
    return {rig_.name,
            fmt::format("the arm reaches {} of {} {}, but there {}", reached_, kTries, where, in_the_way_there_),
            std::string("correct robot.pose and surroundings of the rig") + by_hand};
  const std::string elsewhere = in_the_way_ != nullptr ? std::string("; elsewhere ") + in_the_way_ : "";
  return {rig_.name, "the arm reaches none " + where + elsewhere,
          std::string("correct robot.pose, min and max of the rig") + by_hand};
}

}  // namespace

std::vector<ToolStep> tour(const Rig& rig, unsigned seed, int count) {
  TourPlan plan(rig, seed);
  std::vector<ToolStep> down = plan.with_tool_down(count);
  if (down.size() >= std::min(kFewest, static_cast<std::size_t>(count))) return down;
  std::vector<ToolStep> of_joints = plan.of_joints(count);
  if (of_joints.empty() && down.empty()) throw plan.nothing();
  return of_joints.size() > down.size() ? of_joints : down;
}

void give_start(Rig& rig) {
  const bool names_one = std::ranges::any_of(rig.joints, [](const RigJoint& joint) { return joint.start.has_value(); });
  const bool has_arm = std::ranges::find(rig.joints, JointGroup::arm, &RigJoint::group) != rig.joints.end();
  if (names_one || !rig.robot || !has_arm) return;
  TourPlan plan(rig, 1);
  const auto start = plan.start();
  if (!start) return;
  for (const std::size_t joint : plan.arm_joints()) rig.joints[joint].start = (*start)[joint];
}

}  // namespace foresight
