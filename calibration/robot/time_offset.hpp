// The offset between the clocks of encoders and camera, from motion that both saw.
//
//   t_encoder = t_camera + offset
//   A(t_camera + offset) X = Y B(t_camera)        A: base <- hand, B: target <- camera
//                                                 X: hand <- camera, Y: base <- target
//
// The angular speed is the same in every frame of a rigid body, so that its correlation gives the
// offset to a sample without X and Y (Furrer, Fehr, Novkovic, Sommer, Gilitschenski, Siegwart:
// Evaluation of combined time-offset estimation and hand-eye calibration on robotic datasets, FSR
// 2017). Then all three are refined together, robustly, with A interpolated at the camera's times.
#pragma once

#include "calibration/result/verdict.hpp"
#include "calibration/robot/pose_stream.hpp"
#include "calibration/robot/rigid_math.hpp"

namespace foresight {

struct TimeOffsetOptions {
  double largest_offset_s = 5;  ///< searched to both sides, beyond what is said by `around_s`
  double around_s = 0;          ///< where the search starts
  double segment_s = 2;         ///< stretches whose errors count as independent
  bool rotation_only = false;   ///< the encoder stream knows no positions (swept joints)
};

struct TimeOffsetSummary {
  double offset_s = 0;
  double offset_sigma_s = 0;            ///< from what each stretch changes when it is left out
  double coarse_offset_s = 0;           ///< by correlation
  double correlation = 0;               ///< of the angular speeds at that offset
  bool camera_inverted = false;         ///< the camera stream gives target in camera, not camera in target
  Pose X = Pose::Identity();            ///< T_hand_camera
  Pose Y = Pose::Identity();            ///< T_base_target
  Vector6d X_sigma = Vector6d::Zero();  ///< turn (rad) and shift (m) along the axes of the hand
  double scatter_mm = 0;                ///< median distance of the target's position in the base from its typical one
  double scatter_mrad = 0;              ///< the same of its orientation
  int samples = 0, outliers = 0, segments = 0;
  std::vector<double> residual_time_s, residual_mm, residual_mrad;  ///< per sample: time since the first
  std::vector<double> lag_s, lag_correlation;                       ///< of the search
  std::vector<std::string> notes;
  Verdict verdict;
};

/// Throws InputError: streams that do not overlap (naming both spans), fewer than 50 common
/// samples, too little rotation, speeds that do not correlate.
TimeOffsetSummary solve_time_offset(const std::vector<PoseTrack::Sample>& encoder,
                                    const std::vector<PoseTrack::Sample>& camera, const TimeOffsetOptions& options);

}  // namespace foresight
