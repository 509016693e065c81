// Least squares behind a pan-tilt calibration from tags.
#pragma once

#include "calibration/robot/pan_tilt_problem.hpp"
#include "calibration/robot/pan_tilt_tags.hpp"

namespace foresight {

struct PanTiltTagState {
  PanTiltState head;
  double offset_s = 0;
  bool offset_held = true;
  std::vector<std::array<double, 2>> shafts;  ///< e_k of each view
  std::vector<std::vector<char>> left_out;  ///< of each view's tags; not char of text: std::vector<bool> has no places
  double corner_px = 0.2, shaft_rad = 5e-4;
  bool robust = true;
};

/// Camera by the encoders of a view, e_k = 0.
Pose predicted_left(const PanTiltTagState& state, const PanTiltView& view);

/// Minimises from `state`; view `without` does not count (-1: all do). Throws RuntimeFailure.
void fit_pan_tilt_tags(const std::vector<PanTiltView>& views, const CalibratedCameras& cameras, PanTiltTagState& state,
                       int without = -1);

struct PanTiltTagCovariance {
  Eigen::MatrixXd head;           ///< of the estimated parameters in the order of pan_tilt_names(), then offset_s
  std::vector<std::string> open;  ///< parameters along which no corner tells anything
  Vector6d pose_sigma = Vector6d::Zero();  ///< PanTiltTagSummary::pose_sigma
  double shaft_variance = 0;               ///< mean over views and joints of the variance of e_k
};

PanTiltTagCovariance pan_tilt_tag_covariance(const std::vector<PanTiltView>& views, const CalibratedCameras& cameras,
                                             PanTiltTagState& state);

}  // namespace foresight
