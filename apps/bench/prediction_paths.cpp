#include "apps/bench/prediction_paths.hpp"

#include <algorithm>
#include <limits>
#include <numbers>
#include <random>

#include "apps/bench/prediction_ik_poses.hpp"
#include "common/cpu_time.hpp"
#include "common/error.hpp"
#include "common/text.hpp"
#include "common/text_rows.hpp"

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
  const DescentGoal goal{Pose::Identity(), kinematics.position_only(), kinematics.length()};
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

struct PoseColumns {
  std::string prefix;
  std::array<std::size_t, 7> index;
};

std::vector<PoseColumns> find_columns(const std::vector<std::string>& header) {
  std::vector<PoseColumns> all;
  for (const std::string& name : header) {
    if (!name.ends_with("qw") || name.starts_with("head_")) continue;
    PoseColumns columns{name.substr(0, name.size() - 2), {}};
    std::size_t found = 0;
    for (const char* part : {"x", "y", "z", "qx", "qy", "qz", "qw"}) {
      const auto at = std::find(header.begin(), header.end(), columns.prefix + part);
      if (at != header.end()) columns.index[found++] = static_cast<std::size_t>(at - header.begin());
    }
    if (found == 7) all.push_back(columns);
  }
  return all;
}

Pose read_pose(const std::vector<double>& row, const PoseColumns& columns) {
  const auto at = [&](std::size_t i) { return row[columns.index[i]]; };
  const Eigen::Quaterniond q(at(6), at(3), at(4), at(5));
  if (!(std::abs(q.norm() - 1) < 0.01)) return kUnseen;
  Pose T = Pose::Identity();
  T.linear() = q.normalized().toRotationMatrix();
  T.translation() = Eigen::Vector3d(at(0), at(1), at(2));
  return T;
}

// The recorded motion about its first pose, about the pose of `start` instead.
void move_into_workspace(const InverseKinematics& kinematics, HandPath& path) {
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

std::vector<HandPath> random_paths(const InverseKinematics& kinematics, std::size_t count) {
  UniformJoints joints(kinematics.chain(), 11);
  std::vector<HandPath> paths(count);
  for (HandPath& path : paths) {
    path.name = "random";
    path.start = joints.next();
    const Pose from = kinematics.chain().tip_pose(path.start), to = kinematics.chain().tip_pose(joints.next());
    const Vector6 way = pose_difference(from, to);
    const double turn = kinematics.position_only() ? 0 : way.tail<3>().norm();
    const double seconds = std::max(way.head<3>().norm() / kLinearSpeed, turn / kTurningSpeed);
    const auto cycles = static_cast<std::size_t>(std::ceil(seconds / kCycle)) + 1;
    for (std::size_t i = 1; i <= cycles; ++i)
      path.T_base_tip.push_back(pose_between(from, to, static_cast<double>(i) / static_cast<double>(cycles)));
    path.T_base_tip.insert(path.T_base_tip.end(), static_cast<std::size_t>(kStillFor / kCycle), to);
    path.dt.assign(path.T_base_tip.size(), kCycle);
  }
  return paths;
}

std::vector<HandPath> recorded_paths(const InverseKinematics& kinematics, const std::filesystem::path& csv) {
  std::vector<std::string> header;
  std::size_t time = 0;
  std::vector<PoseColumns> columns;
  std::vector<HandPath> paths;
  double before = 0;
  for_each_row(csv, {RowForm::Between::commas}, [&](const TextRow& line) {
    if (header.empty()) {
      header.assign(line.fields.begin(), line.fields.end());
      time = static_cast<std::size_t>(std::ranges::find(header, "time_s") - header.begin());
      columns = find_columns(header);
      paths.resize(columns.size());
      if (time == header.size() || columns.empty())
        throw InputError(line.where(), "names no time_s or no pose (x y z qx qy qz qw, perhaps after a prefix)",
                         "write the names of the columns in the first line");
      return;
    }
    if (line.fields.size() != header.size())
      throw InputError(line.where(), "has " + std::to_string(line.fields.size()) + " fields",
                       "write " + std::to_string(header.size()) + ", as the first line has");
    std::vector<double> row;
    for (const std::string_view field : line.fields)
      row.push_back(parse_number(field).value_or(std::numeric_limits<double>::quiet_NaN()));
    const double now = row[time];
    if (!std::isfinite(now)) throw InputError(line.where(time), "its time is no number", "write seconds");
    const bool first = paths[0].dt.empty();
    if (!first && !(now > before))
      throw InputError(line.where(time), "its time is not after the one before", "sort the rows by time");
    for (std::size_t c = 0; c < columns.size(); ++c) {
      paths[c].dt.push_back(first ? kCycle : now - before);
      paths[c].T_base_tip.push_back(read_pose(row, columns[c]));
    }
    before = now;
  });
  if (paths.empty() || paths[0].dt.empty()) throw InputError(csv.string(), "has no row", "name a recording");
  const JointVector start = roomy_start(kinematics);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    paths[c].name = columns[c].prefix.empty() ? csv.stem().string() : columns[c].prefix;
    paths[c].start = start;
    move_into_workspace(kinematics, paths[c]);
  }
  return paths;
}

FollowFigures follow(const InverseKinematics& kinematics, const std::vector<HandPath>& paths) {
  FollowFigures figures;
  for (const HandPath& path : paths) {
    PathFollower follower(kinematics, path.start);
    FollowStep step;
    for (std::size_t i = 0; i < path.dt.size(); ++i) {
      const JointVector before = follower.joints();
      const double from = cpu_seconds(CLOCK_THREAD_CPUTIME_ID);
      step = follower.step(path.T_base_tip[i], path.dt[i]);
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
      if (step.reason == FollowReason::none) {
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
    figures.ends_reached += step.reason == FollowReason::none;
  }
  return figures;
}

}  // namespace foresight
