// An exported model as another library reads it, and as it looks.
#pragma once

#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "common/lens.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

/// A glTF file read by assimp, which knows nothing of ours.
class ExportedModel {
 public:
  /// Throws std::runtime_error with assimp's words.
  explicit ExportedModel(const std::filesystem::path& file);

  struct Corner {
    Eigen::Vector3d p_world;  ///< world with z up
    Eigen::Vector2d uv;       ///< 0..1 from the top left of atlas
  };
  using Triangle = std::array<Corner, 3>;

  std::map<std::string, Pose> T_world_node;  ///< of all nodes but the root, world with z up
  std::map<std::string, std::size_t> triangles_of_node;
  std::vector<Triangle> triangles;
  cv::Mat atlas;  ///< CV_8UC3, BGR
  bool unlit = false, two_sided = false;

  /// Bilinear, clamped to the edge, as OpenGL does it.
  Eigen::Vector3d colour(const Eigen::Vector2d& uv) const;

  struct Picture {
    cv::Mat bgr;        ///< CV_8UC3; black where there is no model
    cv::Mat inverse_z;  ///< CV_64F, 1/m; 0 where there is no model
  };
  /// What a camera sees, ray by ray.
  Picture picture(const Lens& lens, const Pose& T_world_camera) const;
};

}  // namespace foresight
