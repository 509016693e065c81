// The pose of a thing at which its outline lies on edges of the pictures: for a thing that nobody saw before.
//
//   residual of a point X of the outline that the camera c sees:
//     r = n . (lens_c(T_camera T X) - m)      n: across the projected edge, m: the nearest edge of the picture along n
//
// found again and again within less and less reach, Huber's loss. Sources: Harris and Stennett, "RAPID, a video rate
// object tracker", BMVC 1990; Drummond and Cipolla, "Real-time visual tracking of complex structures", PAMI 2002.
#pragma once

#include <optional>
#include <span>

#include "calibration/camera/twist.hpp"
#include "prediction/sighting/edge_picture.hpp"
#include "prediction/sighting/front_depth.hpp"
#include "prediction/sighting/thing_shape.hpp"

namespace foresight {

/// One camera's picture of the instant. What it points to outlives it.
struct SeenBy {
  const Lens* lens = nullptr;
  Pose T_world_camera = Pose::Identity();
  const EdgePicture* picture = nullptr;
  const FrontDepth* front = nullptr;
};

/// How far a thing may be from where a fit of its pose begins: one sigma along and about the world's axes, m, rad.
struct StartSigma {
  Eigen::Vector3d place = Eigen::Vector3d::Constant(0.03), turn = Eigen::Vector3d::Constant(0.15);

  /// Information about a small motion of `start` in its own frame (twist.hpp).
  Matrix6d information(const Pose& start) const;
};

struct EdgeFitOptions {
  StartSigma start;
  double reach_px = 6;   ///< how far an edge may be at first
  double edge_px = 0.4;  ///< standard deviation of an edge of a picture, at least
  double alike = 12;     ///< neighbouring points that err alike
  std::size_t fewest_points = 24;
};

struct EdgeFit {
  Pose T_world_thing = Pose::Identity();
  Matrix6d covariance = Matrix6d::Identity();  ///< of a small motion in the thing's frame (twist.hpp)
  double agreement = 0;    ///< share of the visible outline that lies on an edge of the picture, to 1.5 px
  std::size_t points = 0;  ///< visible ones, in all pictures

  double sigma() const { return std::sqrt(covariance.bottomRightCorner<3, 3>().trace() / 3); }  ///< m, each axis
  double sigma_rad() const { return std::sqrt(covariance.topLeftCorner<3, 3>().trace() / 3); }
};

/// A point of the outline that one of the cameras sees.
struct VisiblePoint {
  std::size_t camera = 0;
  const OutlinePoint* point = nullptr;
};
/// With the thing at that pose; `node`: of the scene's model. At most `most` of them, evenly chosen.
std::vector<VisiblePoint> visible_points(const ThingShape& shape, std::size_t node, std::span<const SeenBy> cameras,
                                         const Pose& T_world_thing, std::size_t most);

/// Nothing where too little of it can be seen. Any thread.
std::optional<EdgeFit> fit_edges(const ThingShape& shape, std::size_t node, std::span<const SeenBy> cameras,
                                 const Pose& start, const EdgeFitOptions& options = {});

}  // namespace foresight
