// A two-axis head from the tags of a static map that its cameras see.
//
//   residual of corner X of the map in camera c (0 left, 1 right) of view k:
//     r = (lens_c(T_left_c^-1 T_world_left(shafts_k)^-1 X) - pixel) / corner_px
//     shafts_k = encoders_k + rate_k offset_s + e_k,   e_k / shaft_rad is a residual, too
//
// All corners of all images stand in one problem, with the model of pan_tilt.hpp. e_k is what the encoders did not
// tell of view k: its corners share it, so that many corners of one view do not count as many measurements of the
// head. Both noises are estimated: corner_px from the residuals, shaft_rad by expectation-maximisation (Dempster,
// Laird, Rubin 1977). A tag in an image counts under Cauchy's loss, then is left out where a corner is beyond five
// robust standard deviations.
#pragma once

#include "calibration/camera/rig.hpp"
#include "calibration/result/view_print.hpp"
#include "calibration/robot/pan_tilt.hpp"

namespace foresight {

/// One tag of the map in one image.
struct SeenTag {
  int id = 0;
  int camera = 0;                          ///< 0: left or the only one, 1: right
  std::array<Eigen::Vector3d, 4> corners;  ///< world, metres
  std::array<Eigen::Vector2d, 4> pixels;   ///< px, pixel centres at integers
};

/// What the cameras saw at one instant.
struct PanTiltView {
  std::string name;
  PanTiltAngles angles;
  std::array<double, 2> rate{0, 0};  ///< rad/s of pan and tilt; 0 where the head stood still
  std::vector<SeenTag> tags;
};

struct PanTiltTagOptions {
  std::optional<bool> gains;  ///< as PanTiltOptions
  bool backlash = true;       ///< estimate where a joint came from both sides
  bool offset = false;        ///< estimate offset_s; needs views in motion
  bool score = true;          ///< leave-one-view-out
};

struct PanTiltTagSummary {
  PanTiltModel model;
  double offset_s = 0;             ///< t_encoder = t_camera + offset_s, on top of where the angles were read
  std::vector<std::string> names;  ///< of the estimated parameters, unit as suffix
  std::vector<double> sigmas;      ///< of each
  double corner_px = 0;            ///< noise of a corner, each coordinate
  double shaft_rad = 0;            ///< noise of a shaft's angle against the model
  /// Of the camera's pose by the parameters' covariance, RMS over the views: rotation vector (rad) and place (m), in
  /// the camera's frame. shaft_rad comes on top.
  Vector6d pose_sigma = Vector6d::Zero();
  double in_sample_px = 0;              ///< RMS distance of a corner, shafts as fitted
  double loo_px = 0;                    ///< RMS of corners of a view left out, by its encoders alone
  std::vector<std::string> view_names;  ///< that took part
  std::vector<PanTiltAngles> angles;    ///< of these
  std::vector<double> view_px, loo_view_px;
  int tags = 0, rejected_points = 0;  ///< tags in images; corners left out
  std::vector<std::string> notes;
  Verdict verdict;
};

/// `cameras`: lenses, and where the right camera stands; they stay as they are.
/// Throws InputError: fewer than 8 views with tags, a joint that did not move or only with the other (naming what
/// stays open), angles or a map that fit no two-axis head.
PanTiltTagSummary solve_pan_tilt_tags(const std::vector<PanTiltView>& views, const CalibratedCameras& cameras,
                                      const PanTiltTagOptions& options);

/// Of what each view's tags looked like.
ViewPrints prints_of(const std::vector<PanTiltView>& views);

/// Where each corner of `view` is predicted, in the order of its tags; nothing for one behind its camera.
std::vector<std::optional<Eigen::Vector2d>> predicted_corners(const CalibratedCameras& cameras,
                                                              const Pose& T_world_left, const PanTiltView& view);

/// Distances, px, from the predicted to the seen corners of `view`, in the order of its tags. A corner that the model
/// puts behind a camera is infinitely far.
std::vector<double> corner_errors(const CalibratedCameras& cameras, const Pose& T_world_left, const PanTiltView& view);

}  // namespace foresight
