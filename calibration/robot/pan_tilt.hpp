// Kinematics of a two-axis head: where its camera looks, from two joint angles.
//
//   T_world_camera = T_world_pan Rz(pan') Tx(length) Rx(twist) Rz(tilt') T_tilt_camera
//   pan' = gain_pan pan + backlash_pan/2 d,   d = +1 or -1: the way the joint came; 0 unknown
//
// The axes are the z axes of their frames, the common normal from pan to tilt is x (Denavit,
// Hartenberg 1955): 6 + 2 + 6 = 14 parameters, and none of them says what another says already;
// where both joints stand at zero is part of T_world_pan and T_tilt_camera. Not for parallel axes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/result/verdict.hpp"
#include "calibration/robot/rigid_math.hpp"

namespace foresight {

class YamlMap;

struct PanTiltModel {
  Pose T_world_pan = Pose::Identity();
  double length_m = 0;   ///< between the axes, along their common normal
  double twist_rad = 0;  ///< from the pan axis to the tilt axis, about the common normal
  Pose T_tilt_camera = Pose::Identity();
  std::array<double, 2> gain{1, 1};          ///< true over reported angle: pan, tilt
  std::array<double, 2> backlash_rad{0, 0};  ///< from coming from below to coming from above
};

struct PanTiltAngles {
  double pan = 0, tilt = 0;       ///< rad, as the joints report them
  std::array<int, 2> came{0, 0};  ///< +1: upwards, -1: downwards, 0: unknown
};

Pose camera_pose(const PanTiltModel& model, const PanTiltAngles& angles);

/// The `result` map of a file of kind "pan-tilt". Throws InputError naming file and field.
PanTiltModel read_pan_tilt(const YamlMap& result);

struct PanTiltSample {
  std::string name;
  PanTiltAngles angles;
  Pose T_world_camera = Pose::Identity();
};

struct PanTiltOptions {
  std::optional<bool> gains;  ///< estimate gain_pan and gain_tilt; empty: where the left-out error falls by it
  bool backlash = true;       ///< estimate where a joint came from both sides
  bool robust = true;         ///< noise from the residuals and Cauchy's loss; false: plain least squares, 1 rad = 1 m
  std::optional<bool> inverted;  ///< the poses are T_camera_world; empty: what fits
  bool score = true;             ///< leave-one-pose-out
};

struct PanTiltErrors {
  double mm = 0, mrad = 0;  ///< RMS of position and turn
  double median_mm = 0, median_mrad = 0;
};

struct PanTiltSummary {
  PanTiltModel model;
  bool inverted = false;
  std::vector<std::string> names;       ///< of the estimated parameters, unit as suffix
  std::vector<double> sigmas;           ///< of each
  double sigma_mm = 0, sigma_mrad = 0;  ///< noise of a pose, per axis
  PanTiltErrors in_sample, loo;
  int outliers = 0;                 ///< poses beyond 5 robust sigmas; they count in the errors
  std::vector<Vector6d> loo_steps;  ///< per sample: from predicted to measured pose, in the camera; empty without score
  std::vector<std::string> notes;
  Verdict verdict;
};

/// Throws InputError: fewer than 8 poses, a joint that did not move (naming the parameters that
/// stay open), angles that fit no two-axis head.
PanTiltSummary solve_pan_tilt(const std::vector<PanTiltSample>& samples, const PanTiltOptions& options);

/// Sets angles.came from the order of the samples: the sign of the last change above `least_rad`.
void came_from_order(std::vector<PanTiltSample>& samples, double least_rad = 1e-3);

}  // namespace foresight
