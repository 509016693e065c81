// Tag corners in the world, from images whose poses and lens are known.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "calibration/placement/placement.hpp"
#include "common/lens.hpp"

namespace foresight {

/// One corner of a tag in one image.
struct SeenCorner {
  std::string image;
  long long tag = 0;
  long long corner = 0;  ///< 0 to 3
  Eigen::Vector2d pixel;
};

/// Rows "image id corner u v". Throws InputError naming file and line.
std::vector<SeenCorner> read_seen_corners(const std::filesystem::path& file);

/// Rows "image tx ty tz qx qy qz qw": T_world_camera. Throws InputError naming file and line.
std::map<std::string, Pose> read_image_poses(const std::filesystem::path& file);

/// Pairs of the corners of `model` (rows "id corner x y z") and where the rays of at least two images meet, with the
/// standard deviation that `sigma_px` makes there. Corners whose rays hardly cross (more than 0.1 m), or that one image
/// sees, are left out. Throws InputError: an image without a pose (with the nearest name), a pixel that the lens
/// does not see, no corner left.
std::vector<PointPair> triangulate_tags(const std::filesystem::path& model, const std::vector<SeenCorner>& seen,
                                        const std::map<std::string, Pose>& poses, const Lens& lens, double sigma_px);

}  // namespace foresight
