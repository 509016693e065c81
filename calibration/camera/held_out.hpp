// Errors on views that a calibration has not seen.
//
//   joint     the board's pose is fitted in all cameras: error of each corner, RMS px
//   cross     its pose is fitted in one camera and predicted in the other, both ways: RMS px
//   epipolar  distance to the line that the other camera's ray draws, in the image without
//             distortion, pixels of the camera's own focal lengths: mean px
//
// over all corners of the views, wrong ones too, which a few of can double. The `inlier` figures
// are the same without the corners whose own joint error, where the wrong ones do not draw the pose,
// is beyond the bound by which the solver rejects (RigSolverOptions::reject_sigmas, the deviation
// being that of all views left out). A view that would lose half of its corners keeps them all.
#pragma once

#include "calibration/camera/rig_solver.hpp"

namespace foresight {

struct HeldOutScore {
  double joint_px = 0;
  double cross_px = 0;     ///< of a pair
  double epipolar_px = 0;  ///< of a pair
  int views = 0;           ///< whose pose could be found
  double joint_inlier_px = 0;
  double cross_inlier_px = 0;     ///< of a pair
  double epipolar_inlier_px = 0;  ///< of a pair
  int rejected_points = 0;        ///< which the inlier figures are without, in all cameras
};

/// How a rig explains views, each on its own.
HeldOutScore score_views(const CameraRig& rig, const RigViews& test,
                         double reject_sigmas = RigSolverOptions{}.reject_sigmas);

struct LeaveOut {
  HeldOutScore score;
  int folds = 0;  ///< as many as views: leave one out
};

/// Solves without some of the views and scores these, for each in turn, starting from `solution`
/// of all. `test` holds the corners that score; views of names that it lacks are not scored. Up to
/// `most_folds` views are left out one by one; of more, every `most_folds`-th at once.
LeaveOut leave_out(const RigViews& train, const RigViews& test, const RigSolution& solution,
                   const RigSolverOptions& options, int most_folds);

}  // namespace foresight
