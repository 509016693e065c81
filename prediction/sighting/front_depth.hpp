// What of a scene a camera sees first, roughly: whether a point is hidden behind something.
#pragma once

#include <vector>

#include "common/lens.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

/// Directions that the pixels of a picture look in that is kShrink times smaller than the lens's. Immutable.
class CoarseRays {
 public:
  static constexpr int kShrink = 4;

  explicit CoarseRays(const Lens& lens);

  const Lens& lens() const { return lens_; }
  std::size_t width() const { return width_; }
  std::size_t height() const { return height_; }
  /// Unit, camera frame; zero where the lens sees nothing.
  const Eigen::Vector3d& ray(std::size_t column, std::size_t row) const { return rays_[row * width_ + column]; }

 private:
  Lens lens_;
  std::size_t width_, height_;
  std::vector<Eigen::Vector3d> rays_;
};

/// Immutable; any thread.
class FrontDepth {
 public:
  static constexpr double kMargin = 0.008;  ///< m: what is nearer by less hides nothing

  /// `rays` must outlive this. `scene` has a pose for each of the model's nodes.
  FrontDepth(const CoarseRays& rays, const SceneModel& model, const SceneState& scene, const Pose& T_world_camera);

  /// Does something other than `node` stand before what `pixel` sees at `range` metres?
  bool hidden(const Eigen::Vector2d& pixel, double range, std::size_t node) const;

 private:
  struct Nearest {
    float range = 0;  // 0: nothing
    int node = -1;
  };
  void draw(const Mesh& mesh, const Pose& T_camera_node, int node);
  void draw(const Eigen::Vector3d corner[3], const Eigen::Array2i& least, const Eigen::Array2i& most, int node);

  const CoarseRays& rays_;
  std::vector<Nearest> nearest_;
};

}  // namespace foresight
