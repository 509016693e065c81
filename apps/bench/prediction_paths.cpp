#include "apps/bench/prediction_paths.hpp"

#include <algorithm>
#include <limits>
#include <numbers>
#include <random>

#include "apps/bench/pose_table.hpp"
#include "apps/bench/prediction_ik_poses.hpp"
#include "common/cpu_time.hpp"
#include "common/error.hpp"
#include "common/time.hpp"

namespace foresight {
namespace {

constexpr double kLinearSpeed = 0.1, kTurningSpeed = 0.5;  // m/s, rad/s
constexpr double kCycle = 0.01;                            // s
constexpr double kStillFor = 1;                            // s at the end, to catch up

const Pose kUnseen = [] {
  Pose T = Pose::Identity();
  T.translation().setConstant(std::numeric_limits<double>::quiet_NaN());
  return T;
}();

// Joints from which the hand can go far to all sides: the most mobile and farthest from limits of 500.
JointVector roomy_start(const InverseKinematics& kinematics) {
  const ArmChain& chain = kinematics.chain();
  const DescentGoal goal{Pose::Identity(), kinematics.position_first(), kinematics.length()};
  UniformJoints joints(chain, 7);
  JointVector best = chain.middle();
  double most = -1;
  for (int i = 0; i < 500; ++i) {
    const JointVector q = joints.next();
    TipChange change;
    chain.tip_pose(q, change);
    double room = 1;
    for (Eigen::Index k = 0; k < q.size(); ++k) {
      const double half = 0.5 * (chain.upper()[k] - chain.lower()[k]);
      if (std::isfinite(half)) room = std::min(room, 1 - std::abs(q[k] - chain.middle()[k]) / half);
    }
    const double value = least_mobility(chain, goal, change) * std::min(room, 0.5);
    if (value > most) most = value, best = q;
  }
  return best;
}

// The recorded motion about its first pose, about the pose of `start` instead.
void move_into_workspace(const InverseKinematics& kinematics, PosePath& path) {
  const auto first = std::find_if(path.T_base_tip.begin(), path.T_base_tip.end(),
                                  [](const Pose& T) { return T.matrix().allFinite(); });
  if (first == path.T_base_tip.end()) return;
  const Pose T_first = *first, T_start = kinematics.chain().tip_pose(path.start);
  double farthest = 0;
  for (const Pose& T : path.T_base_tip)
    if (T.matrix().allFinite()) farthest = std::max(farthest, (T.translation() - T_first.translation()).norm());
  path.scale = std::min(1.0, 0.25 * kinematics.chain().reach() / std::max(farthest, 1e-9));
  for (Pose& T : path.T_base_tip) {
    if (!T.matrix().allFinite()) continue;
    const Eigen::Vector3d moved = T.translation() - T_first.translation();
    T.linear() = (T.linear() * T_first.linear().transpose() * T_start.linear()).eval();
    T.translation() = T_start.translation() + path.scale * moved;
  }
}

}  // namespace

std::vector<PosePath> random_paths(const InverseKinematics& kinematics, std::size_t count) {
  UniformJoints joints(kinematics.chain(), 11);
  std::vector<PosePath> paths(count);
  for (PosePath& path : paths) {
    path.name = "random";
    path.start = joints.next();
    const Pose from = kinematics.chain().tip_pose(path.start), to = kinematics.chain().tip_pose(joints.next());
    const Vector6 way = pose_difference(from, to);
    const double turn = way.tail<3>().norm();
    const double seconds = std::max(way.head<3>().norm() / kLinearSpeed, turn / kTurningSpeed);
    const auto cycles = static_cast<std::size_t>(std::ceil(seconds / kCycle)) + 1;
    for (std::size_t i = 1; i <= cycles; ++i)
      path.T_base_tip.push_back(pose_between(from, to, static_cast<double>(i) / static_cast<double>(cycles)));
    path.T_base_tip.insert(path.T_base_tip.end(), static_cast<std::size_t>(kStillFor / kCycle), to);
    path.dt.assign(path.T_base_tip.size(), kCycle);
  }
  return paths;
}

std::vector<PosePath> recorded_paths(const InverseKinematics& kinematics, const std::filesystem::path& csv) {
  const PoseTable table = read_pose_table(csv);
  const JointVector start = roomy_start(kinematics);
  std::vector<PosePath> paths;
  for (const PoseSeries& series : table.series) {
    if (series.prefix == "head_") continue;
    PosePath& path = paths.emplace_back();
    path.name = series.prefix.empty() ? csv.stem().string() : series.prefix;
    path.start = start;
    for (std::size_t i = 0; i < series.poses.size(); ++i) {
      path.dt.push_back(i == 0 ? kCycle : to_seconds(Duration{table.time_ns[i] - table.time_ns[i - 1]}));
      path.T_base_tip.push_back(series.poses[i].value_or(kUnseen));
    }
    move_into_workspace(kinematics, path);
  }
  if (paths.empty())
    throw InputError(csv.string(), "has no pose but the head's", "name a recording of what a hand holds");
  return paths;
}

FollowFigures follow(const InverseKinematics& kinematics, const std::vector<PosePath>& paths) {
  FollowFigures figures;
  for (const PosePath& path : paths) {
    PathFollower follower(kinematics, path.start);
    bool there = false;
    for (std::size_t i = 0; i < path.dt.size(); ++i) {
      const JointVector before = follower.joints();
      const double from = cpu_seconds(CLOCK_THREAD_CPUTIME_ID);
      const FollowStep step = follower.step(path.T_base_tip[i], path.dt[i]);
      const double seconds = cpu_seconds(CLOCK_THREAD_CPUTIME_ID) - from;
      figures.cpu_seconds += seconds;
      figures.slowest_cycle = std::max(figures.slowest_cycle, seconds);
      ++figures.cycles;
      for (std::size_t k = 0; k < kinematics.chain().size(); ++k) {
        const auto at = static_cast<Eigen::Index>(k);
        const double allowed = kinematics.chain().joints()[k].velocity * path.dt[i];
        figures.largest_step_over_limit =
            std::max(figures.largest_step_over_limit, std::abs(step.q[at] - before[at]) / allowed);
      }
      const bool moved = step.q != before;
      there = step.reason == FollowReason::none ||
              (kinematics.position_first() && step.position_error <= kIkExact);  // its turn is another question
      if (there) {
        ++figures.exact;
      } else {
        ++(moved ? figures.slowed : figures.stopped);
        ++(moved ? figures.slowed_by : figures.stopped_by)[name_of(step.reason)];
      }
      if (i % 10 == 0 && path.T_base_tip[i].matrix().allFinite()) {
        ++figures.asked;
        figures.reachable += kinematics.solve(path.T_base_tip[i]).status == IkStatus::solved;
      }
    }
    ++figures.paths;
    figures.ends_reached += there;
  }
  return figures;
}

}  // namespace foresight
