// `foresight bench prediction ik`: inverse kinematics of one arm beside KDL's, and paths that its hand follows.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace foresight {

struct PredictionIkOptions {
  std::filesystem::path urdf;
  std::string tip, base;
  int poses = 100'000;
  int kdl_poses = 10'000;
  int paths = 1'000;
  std::optional<std::filesystem::path> path;
  std::optional<std::filesystem::path> json;
};

/// Prints, and writes to `json`:
///   solved, mean_us, max_us   share of the poses (0 .. 1) reached within 1e-9 m and rad and limits + 1e-12, judged by
///   the
///                             URDF's own frames (scene/urdf_kinematics) and not by what solved them; thread CPU time
///   at_limit_*                the same with one joint of each vector exactly on one of its limits
///   kdl_solved, kdl_mean_us   KDL's NR_JL (start in the middle of the limits, 1e-5, 500 iterations): pose within 1e-4
///   m
///                             and rad, and limits; kdl_lma_*: its LMA (weights 1, 1e-8, start 0). null without KDL
///   largest_step_over_limit   largest step of a joint while following, as a share of velocity limit * cycle
///   followed_*, slowed_*, stopped_*, reachable   shares of the cycles of all paths, and reasons
/// Returns 1 where a step was over its limit, else 0. Throws InputError as read_arm_chain, and for a CSV without such
/// columns.
int bench_prediction_ik(const PredictionIkOptions& options);

}  // namespace foresight
