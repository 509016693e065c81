#include "seat/tour.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <tuple>

#include "common/error.hpp"
#include "input/hand_of_rig.hpp"
#include "seat/ways_to_pose.hpp"

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
constexpr double kLook = 0.02;                         // s between two looks at where the arm is under way
constexpr int kProbes = 300;                           // positions that tell what never comes nearer than at home

/// How a tour is looked for.
struct Care {
  double room;  // share of kTourRoom
  int ways;     // of the joints to a pose that are tried, beside the first that is found
};
// What is near itself wherever it stands, as a small arm with its jaws, has less room.
constexpr Care kCares[] = {{1, 0}, {1, 8}, {0.5, 8}, {0.25, 8}};

class TourPlan {
 public:
  TourPlan(const Rig& rig, unsigned seed)
      : rig_(rig), hand_(arm_options(rig)), kinematics_(*hand_.arm), shape_(rig.shape()), seed_(seed) {
    look_about();
  }
  /// With ever more ways of the joints and ever less room, the tool down at first, until one of the two finds enough.
  bool find(const std::function<bool()>& tool_down, const std::function<bool()>& by_joints);
  std::vector<ToolStep> with_tool_down(int count);
  std::vector<ToolStep> of_joints(int count);
  /// All joints in the middle of where a tour goes.
  bool start();
  const JointValues& at() const { return at_; }
  std::span<const std::size_t> arm_joints() const { return hand_.arm_joints; }
  InputError nothing() const;

 private:
  const ArmChain& chain() const { return kinematics_.chain(); }
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  void begin(const Care& care);
  void leave_room(double room);
  void look_about();
  Pose tool_down(double yaw, double distance, double height, double turn) const;
  Pose tool_down_anywhere();
  std::optional<ToolStep> by_other_joints(const Pose& pose);
  ToolStep to_joints(const JointVector& q) const;
  void look_at(const JointVector& q);
  bool clear(const JointVector& q);
  bool clear_all_the_way(const ToolStep& step);

  const Rig& rig_;
  HandOptions hand_;
  InverseKinematics kinematics_;
  std::unique_ptr<RobotShape> shape_;
  std::vector<double> margins_, least_margins_;  // of its couples
  const unsigned seed_;
  std::mt19937 random_, random_ways_;
  int ways_ = 0;
  double ahead_ = 0;              // rad about the vertical, where the arm looks
  double low_ = 0, high_ = 0;     // m above the world's origin
  JointValues at_;                // of all joints, where the tour has come to
  int reached_ = 0;               // of the poses with the tool down
  std::string in_the_way_;        // of the joints that were looked at last
  std::string in_the_way_there_;  // of the poses with the tool down
};

bool TourPlan::find(const std::function<bool()>& tool_down, const std::function<bool()>& by_joints) {
  for (const Care& care : kCares) {
    begin(care);
    if (tool_down()) return true;
    if (reached_ == 0) break;
  }
  for (const Care& care : kCares) {
    if (care.ways == 0) continue;  // the same room as the next one
    begin(care);
    if (by_joints()) return true;
  }
  return false;
}

/// From home, and by the same poses each time.
void TourPlan::begin(const Care& care) {
  random_.seed(seed_);
  random_ways_.seed(seed_);
  ways_ = care.ways;
  at_ = home_of(rig_);
  if (shape_) leave_room(care.room * kTourRoom * chain().reach());
}

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
  std::mt19937 random(seed_);
  for (int i = 0; i < kProbes; ++i) {
    look_at(any_joints(chain(), random));
    std::ranges::transform(nearest, margins_, nearest.begin(), [](double a, double b) { return std::min(a, b); });
  }
  least_margins_.clear();
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
  const auto end = end_of_clear_way(script, at_, kLook, [this](const JointValues& joints) {
    return clear(joints_of({joints.data(), rig_.joints.size()}, hand_.arm_joints));
  });
  if (end) at_ = *end;
  return end.has_value();
}

std::vector<ToolStep> TourPlan::with_tool_down(int count) {
  std::vector<ToolStep> out;
  reached_ = 0;
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
    else if (const auto other = by_other_joints(pose))
      out.push_back(*other);
    else
      in_the_way_there_ = in_the_way_;
  }
  return out;
}

/// All joints at once, first those that are nearest to where the tour has come to.
std::optional<ToolStep> TourPlan::by_other_joints(const Pose& pose) {
  const Pose T_base_tool = rig_.T_world_robot.inverse() * pose;
  for (const JointVector& q :
       ways_to_pose(kinematics_, T_base_tool, joints_of(at_, hand_.arm_joints), ways_, random_ways_)) {
    const ToolStep step = to_joints(q);
    if (clear(q) && clear_all_the_way(step)) return step;
  }
  return std::nullopt;
}

ToolStep TourPlan::to_joints(const JointVector& q) const {
  ToolStep out{ToolStep::What::there, rig_.T_world_robot * chain().tip_pose(q), {}, 1.5};
  out.joints = q;
  return out;
}

std::vector<ToolStep> TourPlan::of_joints(int count) {
  std::vector<ToolStep> out;
  for (int tries = 0; tries < kTries && static_cast<int>(out.size()) < count; ++tries) {
    const ToolStep step = to_joints(any_joints(chain(), random_));
    if (clear(*step.joints) && clear_all_the_way(step)) out.push_back(step);
  }
  return out;
}

bool TourPlan::start() {
  constexpr int kFew = 50;  // who waits for a window does not wait for a place that is hard to find
  reached_ = 0;
  for (int tries = 0; tries < kFew; ++tries) {
    const Pose pose =
        tries == 0 ? tool_down(0, 0.5 * (kTourNear + kTourFar), 0.5 * (low_ + high_), ahead_) : tool_down_anywhere();
    const IkAnswer answer = kinematics_.solve(rig_.T_world_robot.inverse() * pose);
    if (answer.status != IkStatus::solved) continue;
    ++reached_;
    if ((clear(answer.q) && clear_all_the_way(to_joints(answer.q))) || by_other_joints(pose)) return true;
  }
  return false;
}

InputError TourPlan::nothing() const {
  const std::string where =
      fmt::format("of the tour's poses, {:.2f} to {:.2f} m above the world's origin, tool down", low_, high_);
  const char* const by_hand = ", or operate it by hand, without --scripted";
  if (!in_the_way_there_.empty())
    return {rig_.name,
            fmt::format("the arm reaches {} of {} {}, but there {}", reached_, kTries, where, in_the_way_there_),
            std::string("correct robot.pose and surroundings of the rig") + by_hand};
  const std::string elsewhere = in_the_way_.empty() ? "" : "; elsewhere " + in_the_way_;
  return {rig_.name, "the arm reaches none " + where + elsewhere,
          std::string("correct robot.pose, min and max of the rig") + by_hand};
}

}  // namespace

std::vector<ToolStep> tour(const Rig& rig, unsigned seed, int count) {
  TourPlan plan(rig, seed);
  std::vector<ToolStep> best;
  const auto is_enough = [&](std::vector<ToolStep> steps) {
    if (steps.size() > best.size()) best = std::move(steps);
    return best.size() >= std::min(kFewest, static_cast<std::size_t>(count));
  };
  plan.find([&] { return is_enough(plan.with_tool_down(count)); }, [&] { return is_enough(plan.of_joints(count)); });
  if (best.empty()) throw plan.nothing();
  return best;
}

void give_start(Rig& rig) {
  const bool names_one = std::ranges::any_of(rig.joints, [](const RigJoint& joint) { return joint.start.has_value(); });
  const bool has_arm = std::ranges::find(rig.joints, JointGroup::arm, &RigJoint::group) != rig.joints.end();
  if (names_one || !rig.robot || !has_arm) return;
  TourPlan plan(rig, 1);
  if (!plan.find([&] { return plan.start(); }, [&] { return !plan.of_joints(1).empty(); })) return;
  for (const std::size_t joint : plan.arm_joints()) rig.joints[joint].start = plan.at()[joint];
}

}  // namespace foresight
