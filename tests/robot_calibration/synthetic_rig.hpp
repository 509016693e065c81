// Rigs with a known truth.
#pragma once

#include <cstdlib>
#include <random>

#include "calibration/robot/hand_eye.hpp"
#include "calibration/robot/joint_chain.hpp"
#include "calibration/robot/pan_tilt.hpp"
#include "calibration/robot/pose_stream.hpp"

namespace foresight {

using Random = std::mt19937_64;

double normal(Random& random, double sigma);
Eigen::Vector3d normal3(Random& random, double sigma);
Pose random_pose(Random& random, double turn, double shift);

/// Moved by a step that is normal in every coordinate.
Pose noisy(const Pose& pose, Random& random, double sigma_rad, double sigma_m);

struct HandEyeRig {
  HandEyeData data;
  Pose X, Y;
  CameraModel camera;
};

struct HandEyeRigOptions {
  CameraMount mount = CameraMount::fixed;
  int views = 14, cols = 6, rows = 4;
  double size_m = 0.03;
  double noise_px = 0.2, noise_rad = 5e-4, noise_m = 3e-4;
  bool one_axis = false;  ///< the wrist turns about one axis only
};

/// A camera of 1280x960 px, 0.5 to 0.9 m before the board, that is turned by up to 35 degrees.
HandEyeRig make_rig(Random& random, const HandEyeRigOptions& options);

struct JointRig {
  HandEyeRig rig;
  std::vector<std::vector<double>> rows;  ///< what the joints report, rad, one row a view
};

/// A fixed camera before an arm whose joints stand `offsets` away from what they report: up to 25 views, corners with
/// a noise of 0.1 px.
JointRig make_joint_rig(JointChain& chain, const std::vector<double>& offsets, Random& random);

/// Differences of a result to the truth over their standard deviations: turn about and shift along
/// the parent's axes, six numbers.
Vector6d in_sigmas(const Pose& found, const Pose& truth, const Vector6d& sigma);

struct StreamRig {
  std::vector<PoseTrack::Sample> encoder, camera;
  double offset_s = 0;
  Pose X, Y;
};

/// `seconds` of smooth motion, encoders at 100 Hz and camera at 30 Hz with noise, 1 % wild camera
/// poses and a drop-out; stamps at the scale of unix times.
StreamRig make_streams(Random& random, double seconds, double offset_s, bool camera_inverted = false);

/// Poses of a head at random angles, both ways of approach.
std::vector<PanTiltSample> make_head(Random& random, const PanTiltModel& model, int poses, double sigma_rad,
                                     double sigma_m);
PanTiltModel random_head(Random& random);

inline bool long_run() {
  return std::getenv("FORESIGHT_LONG") != nullptr;
}

}  // namespace foresight
