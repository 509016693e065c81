// Where a model stands in the world, from points that were measured in both.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "calibration/result/verdict.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

struct PointPair {
  std::string name;         ///< for messages: "point 3", "tag 7 corner 2"
  Eigen::Vector3d p_model;  ///< m
  Eigen::Vector3d p_world;  ///< m
  double sigma_m = 0;       ///< of a coordinate of the difference; 0: the option's
};

struct PlacementOptions {
  double sigma_m = 0.005;         ///< a tape measure's
  double worst_sigmas = 4;        ///< a point farther off than this many times sqrt(3) sigma is refused
  double scale_tolerance = 0.02;  ///< model and world sizes may differ by this much, or by the noise
};

struct PlacementSummary {
  Pose T_world_model = Pose::Identity();
  std::vector<double> residual_m;  ///< distance of each point
  double rms_m = 0;
  double loo_m = 0;               ///< RMS of points that the solver had not seen; NaN for three points
  double scale = 1;               ///< world over model, as the points have it; not applied
  double sigma_position_m = 0;    ///< of the model at the centre of its points, root of the three variances' sum
  double sigma_rotation_rad = 0;  ///< the same for its rotation
  std::vector<std::string> warnings;
  Verdict verdict;
};

/// Umeyama's fit without scale on the three points that most others agree with, then all points in Ceres: residual
/// (T p_model - p_world) / sigma, Cauchy loss at 2. Throws InputError where the points cannot place a model, or do
/// not fit, naming the cause: fewer than 3, on a line, another unit (with the unit), mirrored, single points (with
/// their distance).
PlacementSummary place_model(const std::vector<PointPair>& points, const PlacementOptions& options = {});

/// Rows "x y z X Y Z" (model, world) or "x y z X Y Z sigma", metres. Throws InputError naming file and line.
std::vector<PointPair> read_point_pairs(const std::filesystem::path& file);

/// "tag 7 corner 2".
std::string tag_corner_name(long long tag, long long corner);

/// Rows "id corner x y z", corner 0 to 3, metres, by tag and corner. Throws InputError naming file and line: another
/// form, a corner given twice.
std::map<std::pair<long long, long long>, Eigen::Vector3d> read_tag_places(const std::filesystem::path& file);

/// The same in the order of the tags; p_model is set. Throws InputError naming file and line.
std::vector<PointPair> read_tag_corners(const std::filesystem::path& file);

/// Tags: rows "id corner x y z" (corner 0 to 3) of the model and of the world; corners in both become pairs.
/// Throws InputError naming file and line: a corner given twice; no tag in both.
std::vector<PointPair> read_tag_pairs(const std::filesystem::path& model, const std::filesystem::path& world);

}  // namespace foresight
