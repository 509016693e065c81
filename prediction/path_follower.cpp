#include "prediction/path_follower.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>

#include "common/rotation.hpp"

namespace foresight {
namespace {

constexpr double kThere = 1e-12;        // weighted error at which the hand is at its target
constexpr double kOnLine = 2e-10;       // weighted error at which a point of the line is reached
constexpr double kSmallestPart = 1e-3;  // of the way, in one cycle: slower, the hand leaves its line instead
constexpr int kTurnsACycle = 2;         // towards the hand's orientation in a cycle, where the position comes first
constexpr double kTurnTold = 0.05;      // rad: a hand that such an arm turns no nearer than this is told of
constexpr double kGain = 1e-9;          // weighted error that a step must take away to count as one

}  // namespace

const char* name_of(FollowReason reason) noexcept {
  switch (reason) {
    case FollowReason::none: return "none";
    case FollowReason::joint_speed: return "joint speed";
    case FollowReason::joint_limit: return "joint limit";
    case FollowReason::singularity: return "singularity";
    case FollowReason::out_of_reach: return "out of reach";
    case FollowReason::few_joints: return "too few joints";
    case FollowReason::other_branch: return "other branch";
    case FollowReason::contact: return "contact";
    case FollowReason::unknown: return "unknown";
    case FollowReason::bad_target: return "bad target";
  }
  return "";
}

// What holds within one cycle.
struct PathFollower::Cycle {
  DescentGoal goal;
  JointVector lower, upper;  // how far each joint may go
  double error = 0;          // weighted, at the start
};

PathFollower::PathFollower(const InverseKinematics& kinematics, const JointVector& start, const FollowOptions& options)
    : kinematics_(kinematics), chain_(kinematics.chain()), options_(options) {
  stand_at(start);
}

void PathFollower::stand_at(const JointVector& q) noexcept {
  q_ = q.size() == chain_.middle().size() && q.allFinite() ? q.cwiseMax(chain_.lower()).cwiseMin(chain_.upper()).eval()
                                                           : chain_.middle();
  hand_ = chain_.tip_pose(q_);
  detour_.reset();
  stuck_target_.reset();
}

// Away from limits (the fourth power of how far a joint is from its middle) and towards where the hand is mobile in all
// directions: the gradient of log sqrt(det(J J')), Yoshikawa's measure, from the derivatives of the columns of J.
JointVector PathFollower::freedom(const TipChange& change) const noexcept {
  const std::size_t n = chain_.size();
  const std::span<const ArmLine> lines = chain_.lines();
  const double length = kinematics_.length();
  LineChange by_line;
  chain_.tip_pose(q_, by_line);
  std::array<Vector6, kMostArmJoints> solved;
  Eigen::Matrix<double, 6, 6> A = 1e-6 * Eigen::Matrix<double, 6, 6>::Identity();
  const auto weighted = [&](Vector6 column) {
    column.head<3>() /= length;
    return column;
  };
  for (std::size_t i = 0; i < n; ++i) {
    const Vector6 column = weighted(change[i]);
    A.noalias() += column * column.transpose();
  }
  const auto factor = A.llt();
  for (std::size_t i = 0; i < n; ++i) solved[i] = factor.solve(weighted(change[i]));
  JointVector wish = JointVector::Zero(static_cast<Eigen::Index>(n));
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const Eigen::Vector3d v_k = by_line[k].head<3>(), w_k = by_line[k].tail<3>();
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const Eigen::Vector3d v_i = by_line[i].head<3>(), w_i = by_line[i].tail<3>();
      Vector6 derivative;
      if (k <= i)
        derivative << w_k.cross(v_i), w_k.cross(w_i);
      else
        derivative << w_i.cross(v_k), Eigen::Vector3d::Zero();
      wish[static_cast<Eigen::Index>(lines[k].joint)] +=
          lines[k].factor * lines[i].factor * weighted(derivative).dot(solved[lines[i].joint]);
    }
  }
  for (Eigen::Index at = 0; at < wish.size(); ++at) {
    wish[at] = std::clamp(wish[at], -3.0, 3.0);
    const double half = 0.5 * (chain_.upper()[at] - chain_.lower()[at]);
    if (!std::isfinite(half)) continue;
    const double off = (q_[at] - chain_.middle()[at]) / half;
    wish[at] -= 4 * off * off * off / std::max(1.02 - std::abs(off), 0.02) * 0.25;
  }
  return wish;
}

// One pose, within what the cycle allows.
bool PathFollower::reach(const Pose& pose, const Cycle& cycle, JointVector& q) const noexcept {
  DescentGoal goal = cycle.goal;
  goal.T_base_tip = pose;
  if (!reach_place(goal, cycle, q)) return false;
  if (kinematics_.position_first())
    q = turned_to_goal(chain_, goal, {cycle.lower, cycle.upper, kTurnsACycle, kOnLine, false}, q);
  return true;
}

// By Newton's method: all of the goal, or its position where that comes first.
bool PathFollower::reach_place(const DescentGoal& goal, const Cycle& cycle, JointVector& q) const noexcept {
  TipChange change;
  q = q_;
  const bool redundant = chain_.size() > 6;
  for (int round = 0; round < 10; ++round) {
    const Vector6 e = weighted_error(chain_.tip_pose(q, change), goal);
    const double error = e.norm();
    if (error <= kOnLine && (round > 0 || error <= kThere)) return true;
    const double mu = 1e-3 * error * error + 1e-14;
    JointVector dq = damped_step(chain_, goal, change, e, mu, q, cycle.lower, cycle.upper);
    if (round == 0 && redundant && options_.freedom > 0) {
      JointVector wish = freedom(change);
      const double wanted = wish.cwiseAbs().maxCoeff(), own = options_.freedom * dq.cwiseAbs().maxCoeff();
      if (wanted > 0) {
        wish *= std::min(own / wanted, 0.05);
        dq = damped_step(chain_, goal, change, e, mu, q, cycle.lower, cycle.upper, &wish);
      }
    }
    q = (q + dq).cwiseMax(cycle.lower).cwiseMin(cycle.upper);
  }
  return weighted_error(chain_.tip_pose(q), goal).norm() <= kOnLine;
}

// As much of the straight way as the cycle allows: by what the tangent says, then by halving. 0: next to none.
double PathFollower::reach_part(const Pose& target, const Cycle& cycle, JointVector& q) const noexcept {
  TipChange change;
  const Vector6 e = weighted_error(chain_.tip_pose(q_, change), cycle.goal);
  const double infinity = std::numeric_limits<double>::infinity();
  const JointVector low = JointVector::Constant(q_.size(), -infinity),
                    high = JointVector::Constant(q_.size(), infinity);
  const JointVector free = damped_step(chain_, cycle.goal, change, e, 1e-10, q_, low, high);
  double needed = 1;
  for (Eigen::Index i = 0; i < q_.size(); ++i) {
    const double room = free[i] > 0 ? cycle.upper[i] - q_[i] : q_[i] - cycle.lower[i];
    if (room > 0) needed = std::max(needed, std::abs(free[i]) / room);
  }
  double done = 0, failed = 1;
  double part = std::clamp(1.2 / needed, kSmallestPart, 0.5);
  for (int round = 0; round < 9; ++round) {
    JointVector there;
    if (reach(pose_between(hand_, target, part), cycle, there)) {
      done = part;
      q = there;
      if (failed - done < 0.1 * failed) break;
      part = failed < 1 || round > 2 ? 0.5 * (done + failed) : std::min(1.6 * part, 0.5 * (part + 1));
    } else {
      failed = part;
      part = done > 0 ? 0.5 * (done + failed) : 0.5 * part;
      if (part < kSmallestPart) break;
    }
  }
  return done;
}

// Where no step brings the hand nearer, joints that do may still be near: an arm stretched out towards its target has
// to bend first, sideways.
bool PathFollower::way_round(const Pose& target, const Cycle& cycle, JointVector& q, FollowReason& why) noexcept {
  const auto apart = [&](const Pose& a) {
    const Vector6 d = pose_difference(a, target);
    return d.head<3>().norm() / kinematics_.length() + d.tail<3>().norm();
  };
  if (detour_ && apart(detour_target_) > 0.2) detour_.reset();
  if (!detour_) {
    why = stuck_why_;
    if (stuck_target_ && apart(*stuck_target_) < 1e-3) return false;
    const IkAnswer there = kinematics_.solve(target, q_, 0);
    stuck_target_ = target;
    stuck_why_ = there.status == IkStatus::solved ? FollowReason::other_branch : FollowReason::out_of_reach;
    why = stuck_why_;
    if (there.status != IkStatus::solved || there.largest_change > options_.way_round || there.largest_change < 1e-9)
      return false;
    detour_ = there.q;
    detour_target_ = target;
    stuck_target_.reset();
  }
  const JointVector way = *detour_ - q_;
  double share = 1;
  for (Eigen::Index i = 0; i < way.size(); ++i) {
    const double room = way[i] > 0 ? cycle.upper[i] - q_[i] : q_[i] - cycle.lower[i];
    if (std::abs(way[i]) > room) share = std::min(share, room / std::abs(way[i]));
  }
  q = (q_ + share * way).cwiseMax(cycle.lower).cwiseMin(cycle.upper);
  if (share >= 1) detour_.reset();
  why = FollowReason::singularity;
  return true;
}

void PathFollower::name_reason(const Cycle& cycle, const JointVector& before, FollowStep& step) const noexcept {
  TipChange change;
  chain_.tip_pose(step.q, change);
  double fastest = 0;
  int at_limit = -1, at_speed = -1;
  for (Eigen::Index i = 0; i < step.q.size(); ++i) {
    const double room = std::max(cycle.upper[i] - before[i], before[i] - cycle.lower[i]);
    const double used = std::abs(step.q[i] - before[i]) / std::max(room, 1e-300);
    if (used > fastest) {
      fastest = used;
      at_speed = static_cast<int>(i);
    }
    if (step.q[i] <= chain_.lower()[i] + 1e-9 || step.q[i] >= chain_.upper()[i] - 1e-9) at_limit = static_cast<int>(i);
  }
  const bool slow = fastest < 0.5;
  if (!(slow && at_limit >= 0) && least_mobility(chain_, cycle.goal, change) < options_.singular) {
    step.reason = FollowReason::singularity;
    return;
  }
  const bool limited = at_limit >= 0 && (slow || !step.on_line);
  step.reason = limited ? FollowReason::joint_limit : FollowReason::joint_speed;
  step.joint = limited ? at_limit : at_speed;
}

// Where the position is reached: what keeps the arm from turning as the hand does. The joint that would go farthest
// beyond what the cycle allows, if any would.
void PathFollower::name_turn_left(const Pose& target, FollowStep& step) const noexcept {
  if (step.rotation_error < kTurnTold) return;
  const double endless = std::numeric_limits<double>::infinity();
  const DescentLimits free{JointVector::Constant(q_.size(), -endless), JointVector::Constant(q_.size(), endless), 1,
                           kOnLine, false};
  const JointVector wanted = turned_to_goal(chain_, {target, true, kinematics_.length()}, free, step.q) - step.q;
  Eigen::Index joint = 0;
  step.reason = FollowReason::few_joints;
  if (!(wanted.cwiseAbs().maxCoeff(&joint) > kTurnTold)) return;
  const bool at_limit = step.q[joint] <= chain_.lower()[joint] + 1e-9 || step.q[joint] >= chain_.upper()[joint] - 1e-9;
  step.reason = at_limit ? FollowReason::joint_limit : FollowReason::joint_speed;
  step.joint = static_cast<int>(joint);
}

FollowStep PathFollower::finish(const Pose& target, const Cycle& cycle, const JointVector& q) noexcept {
  FollowStep step;
  q_ = step.q = q;
  hand_ = step.T_base_tip = chain_.tip_pose(q);
  const Vector6 left = pose_difference(hand_, target);
  step.position_error = left.head<3>().norm();
  step.rotation_error = left.tail<3>().norm();
  const double error = weighted_error(hand_, cycle.goal).norm();
  step.progress = cycle.error > kThere ? 1 - error / cycle.error : 1;
  return step;
}

FollowStep PathFollower::step(const Pose& target, double dt) noexcept {
  Cycle cycle{{target, kinematics_.position_first(), kinematics_.length()}, q_, q_, 0};
  if (!is_rigid(target) || !(dt > 0) || !std::isfinite(dt)) {
    cycle.goal.T_base_tip = hand_;
    FollowStep stand = finish(hand_, cycle, q_);
    stand.reason = FollowReason::bad_target;
    stand.progress = 0;
    return stand;
  }
  for (Eigen::Index i = 0; i < q_.size(); ++i) {
    // A little less than the limit: the caller's own rounding must not find more.
    const double room = chain_.joints()[static_cast<std::size_t>(i)].velocity * dt * (1 - 1e-9);
    cycle.lower[i] = std::max(q_[i] - room, chain_.lower()[i]);
    cycle.upper[i] = std::min(q_[i] + room, chain_.upper()[i]);
  }
  cycle.error = weighted_error(hand_, cycle.goal).norm();
  const JointVector before = q_;
  JointVector q = q_;
  if (detour_) {
    FollowReason why{};
    if (way_round(target, cycle, q, why)) {
      FollowStep step = finish(target, cycle, q);
      step.on_line = false;
      step.reason = weighted_error(hand_, cycle.goal).norm() <= kOnLine ? FollowReason::none : why;
      return step;
    }
  }
  if (reach(target, cycle, q)) {
    stuck_target_.reset();
    FollowStep step = finish(target, cycle, q);
    if (kinematics_.position_first()) name_turn_left(target, step);
    return step;
  }
  if (reach_part(target, cycle, q) > 0) {
    stuck_target_.reset();
    FollowStep step = finish(target, cycle, q);
    name_reason(cycle, before, step);
    return step;
  }
  // No point of the line can be reached exactly: as near to the target as the cycle allows.
  const DescentLimits limits{cycle.lower, cycle.upper, 20, 1e-12, false};
  const DescentEnd end = descend(chain_, cycle.goal, limits, q_);
  FollowReason why = FollowReason::none;
  const bool nearer = end.error < cycle.error - kGain;
  if (nearer) {
    q = end.q;
    stuck_target_.reset();
  }
  const bool round = !nearer && way_round(target, cycle, q, why);
  FollowStep step = finish(target, cycle, nearer || round ? q : before);
  step.on_line = false;
  if (nearer)
    name_reason(cycle, before, step);
  else
    step.reason = why;
  return step;
}

}  // namespace foresight
