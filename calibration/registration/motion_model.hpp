// How a camera goes on, from exact poses of the past and inexact ones since.
//
//   x(t)   motion of the camera since its newest refined pose, px: a line plus a Gaussian process,
//          covariance reach^2 exp(-(t - t')^2 / (2 smooth^2))
//   refined pose at t:  x(t) + noise
//   given pose at t:    x(t) + e(t), covariance of e: given^2 exp(-|t - t'| / persist), or white
//
// The mean of x at the wanted instant is a sum of the poses with weights that depend only on the
// instants, the same for all six components. Source: Rasmussen and Williams, "Gaussian Processes for
// Machine Learning", 2006, eq. 2.23 and 2.24.
#pragma once

#include <Eigen/Core>

namespace foresight {

struct MotionModel {
  double smooth_s = 0.14;  ///< over which a motion bends
  double reach_px = 10;    ///< how far it bends away from a line
  double persist_s = 0;    ///< over which given poses keep their error; 0: each has its own
  double given_px = 2;     ///< error of given poses
  double refined_px = 0.02;
};

struct MotionWeights {
  Eigen::VectorXd refined, given;
  double sigma_px = 0;  ///< of the mean, where the model holds
};

/// The weights for instant `wanted` (seconds, as all times; any zero near them). Any thread.
MotionWeights motion_weights(const MotionModel& model, const Eigen::VectorXd& refined, const Eigen::VectorXd& given,
                             double wanted);

}  // namespace foresight
