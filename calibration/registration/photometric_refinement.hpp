// The pose of one image, made to agree with the rendered textured model.
//
//   residual at pixel x of the view, surface point X in the view's camera frame:
//     r = I(lens(D^-1 X)) - gain * R(x) - bias        D = T_view_image, six unknowns
//
//   I: the image, R: the view, both grey and blurred alike on each level, coarse to fine. Slopes
//   are those of R (inverse compositional: they and the projection's do not change), Huber's loss with
//   a scale from the median of the residuals, nothing beyond five of them.
//
// Every fourth block of 16x16 pixels takes no part; it judges the result. Sources: Baker and
// Matthews, "Lucas-Kanade 20 years on", IJCV 2004; covariance by blocks: Cameron and Miller, "A
// practitioner's guide to cluster-robust inference", 2015.
#pragma once

#include <string>

#include "calibration/camera/twist.hpp"
#include "calibration/registration/rendered_view.hpp"
#include "common/lens.hpp"

namespace foresight {

struct RefinementOptions {
  int coarsest_level = 3;     ///< halvings of the image at the start; errors up to about 3 * 2^level px are found
  int iterations = 12;        ///< at most, per level
  int edge_px = 3;            ///< pixels beside depth discontinuities and unseen texels that are left out
  double range_step = 0.03;   ///< a depth discontinuity: neighbours whose ranges differ by more than this share
  double least_gradient = 4;  ///< 8-bit values per px; flatter pixels say nothing
  std::size_t fewest_points = 300;
  double largest_px = 12;    ///< a correction that moves the picture further is refused
  double least_gain = 0.02;  ///< share by which the error on the judging blocks must fall, unless the motion is tiny
  /// Prior of the correction: its mean is the view's pose. Zero: none.
  Matrix6d prior_information = Matrix6d::Zero();
};

struct RefinementSummary {
  bool accepted = false;
  std::string reason;         ///< why not; empty where accepted
  Pose T_world_camera;        ///< refined; the view's own where not accepted
  Matrix6d covariance;        ///< of the motion D (twist.hpp), camera frame
  Matrix6d px_metric;         ///< twist^T px_metric twist = mean squared displacement, px^2
  double moved_px = 0;        ///< root mean square displacement by the correction
  double sigma_px = 0;        ///< predicted error of the refined pose, root mean square over the points
  double gain = 1, bias = 0;  ///< of the image against the view, 8-bit values
  double error_before = 0;    ///< mean Huber loss on the judging blocks at the view's pose
  double error_after = 0;     ///< the same at the refined pose
  std::size_t points = 0;     ///< that took part on the finest level
};

/// Finds the pose from which `image` (CV_8UC1 or CV_8UC3, of the lens's size) was taken. Throws
/// std::invalid_argument for sizes that do not fit. Any thread.
RefinementSummary refine_pose(const Lens& lens, const RenderedView& view, const cv::Mat& image,
                              const RefinementOptions& options);

}  // namespace foresight
