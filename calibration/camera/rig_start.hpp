// Where the bundle adjustment begins: focal lengths, board poses and the place of the right camera
// from nothing but corners.
#pragma once

#include "calibration/camera/rig_solver.hpp"

namespace foresight {

/// A camera alone with `distortion`: image size as in `views`, principal point in the middle, no
/// distortion, the focal length that explains a few views best (tried from fish-eye to telephoto).
/// `views.cameras` must be 1 and its sizes known. Throws InputError where no view can be explained.
RigSolution start_camera(const RigViews& views, Distortion distortion);

/// The views of one of two cameras, and which views of `all` they are.
struct CameraViews {
  RigViews views;
  std::vector<std::size_t> indices;
};
CameraViews views_of(const RigViews& all, int camera);

/// A pair from its two cameras solved alone: T_left_right as most views see it. Throws InputError
/// where no view was seen by both.
RigSolution start_pair(const RigViews& all, const RigSolution& left, const RigSolution& right);

/// One of the cameras on its own, from nothing; the board is taken as flat.
RigSolution solve_alone(const RigViews& all, int camera, Distortion distortion, const RigSolverOptions& options);

/// All cameras from nothing: each alone, then together. Throws InputError as the steps do.
RigSolution solve_from_nothing(const RigViews& all, Distortion distortion, const RigSolverOptions& options);

}  // namespace foresight
