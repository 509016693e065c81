// Paths for a hand to follow, and what became of them.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "prediction/path_follower.hpp"

namespace foresight {

/// One hand: where it wants to be, cycle after cycle.
struct PosePath {
  std::string name;
  std::vector<double> dt;        ///< s, of the cycle that ends with the pose
  std::vector<Pose> T_base_tip;  ///< not finite where the hand was not seen
  JointVector start;
  double scale = 1;  ///< of what was recorded
};

/// Straight lines, evenly along and around, between the poses of uniform joint vectors, at 0.1 m/s and 0.5 rad/s at
/// most, 100 poses a second. Always the same ones.
std::vector<PosePath> random_paths(const InverseKinematics& kinematics, std::size_t count);

/// All hands of a CSV: columns PREFIXx PREFIXy PREFIXz PREFIXqx PREFIXqy PREFIXqz PREFIXqw for each prefix there is,
/// and time_s. The first pose is put where the arm has room, and motion about it scaled down to a sphere of a quarter
/// of the arm's reach where it is larger. Heads are left out. Throws InputError with file and line.
std::vector<PosePath> recorded_paths(const InverseKinematics& kinematics, const std::filesystem::path& csv);

/// Shares are of all cycles.
struct FollowFigures {
  std::size_t paths = 0, ends_reached = 0, cycles = 0;
  std::size_t exact = 0, slowed = 0, stopped = 0;
  std::size_t reachable = 0, asked = 0;  ///< of every tenth pose, those that any joints within limits reach
  std::map<std::string, std::size_t> slowed_by, stopped_by;
  double largest_step_over_limit = 0;  ///< largest step / (velocity * dt)
  double cpu_seconds = 0, slowest_cycle = 0;
};

FollowFigures follow(const InverseKinematics& kinematics, const std::vector<PosePath>& paths);

}  // namespace foresight
