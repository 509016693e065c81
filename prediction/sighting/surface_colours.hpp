// What colours a thing has at points of its surface, as earlier pictures showed them, and the pose at which it shows
// them again.
//
//   residual of a surface point X that the camera c sees, in each channel:
//     r = I_c(lens_c(T_camera T X)) - gain colour(X)        gain: one for all, by the median
//
// on a coarse level of the pictures first, Huber's loss. Sources: Baker and Matthews, "Lucas-Kanade 20 years on", IJCV
// 2004; Crivellaro and Lepetit, "Robust 3D tracking with descriptor fields", CVPR 2014, on why levels are needed.
#pragma once

#include <array>

#include "prediction/sighting/edge_fit.hpp"

namespace foresight {

struct ColourFit {
  Pose T_world_thing = Pose::Identity();
  Matrix6d covariance = Matrix6d::Identity();  ///< of a small motion in the thing's frame (twist.hpp)
  double difference = 0;                       ///< grey levels: the median of |r|
  std::size_t points = 0;                      ///< that can be compared, in all pictures
};

/// A point of the surface that a camera sees.
struct SurfaceView {
  std::size_t camera = 0, point = 0;
};
/// With the thing at that pose; `hiding`: what stands before it counts.
std::vector<SurfaceView> surface_views(const ThingShape& shape, std::size_t node, std::span<const SeenBy> cameras,
                                       const Pose& T_world_thing, bool hiding = true);
/// Share of the surface towards a camera that is in its picture and not hidden by others, of the camera that sees most.
double uncovered_share(const ThingShape& shape, std::size_t node, std::span<const SeenBy> cameras,
                       const Pose& T_world_thing);

/// One thread.
class SurfaceColours {
 public:
  explicit SurfaceColours(std::size_t points) : colours_(points) {}

  bool known() const { return known_; }
  /// The thing is there: what is seen of it is remembered.
  void learn(const ThingShape& shape, std::size_t node, std::span<const SeenBy> cameras, const Pose& T_world_thing);

  /// Nothing where too few points can be compared.
  std::optional<ColourFit> fit(const ThingShape& shape, std::size_t node, std::span<const SeenBy> cameras,
                               const Pose& start, const StartSigma& sigma) const;
  /// As ColourFit::difference, there.
  std::optional<double> difference(const ThingShape& shape, std::size_t node, std::span<const SeenBy> cameras,
                                   const Pose& T_world_thing) const;
  /// Mean of |r| on the coarse level, each at most 60 grey levels, for a search; `views`: of surface_views() nearby.
  double coarse_difference(const ThingShape& shape, std::span<const SeenBy> cameras, std::span<const SurfaceView> views,
                           const Pose& T_world_thing) const;
  bool knows(std::size_t point) const { return colours_[point].seen > 0; }

 private:
  struct Colour {
    std::array<Eigen::Vector3d, EdgePicture::kLevels> mean{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    int seen = 0;
  };
  struct Problem;
  double gain(const ThingShape& shape, std::span<const SeenBy> cameras, std::span<const SurfaceView> views,
              std::size_t level, const Pose& T_world_thing) const;
  std::optional<double> difference(const ThingShape& shape, std::span<const SeenBy> cameras,
                                   std::span<const SurfaceView> views, const Pose& T_world_thing) const;
  std::vector<SurfaceView> known_views(const ThingShape& shape, std::size_t node, std::span<const SeenBy> cameras,
                                       const Pose& T_world_thing) const;

  std::vector<Colour> colours_;  // of each of the shape's surface points
  bool known_ = false;
};

}  // namespace foresight
