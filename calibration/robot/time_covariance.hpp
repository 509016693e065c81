// How uncertain a time offset and its hand-eye are, from streams whose errors are correlated over some time.
#pragma once

#include <ceres/crs_matrix.h>

#include <Eigen/Core>
#include <vector>

namespace foresight {

struct StretchCovariance {
  Eigen::MatrixXd covariance;
  int stretches = 0;  ///< of `segment_s` that hold residuals
};

inline constexpr int kFewestStretches = 8;

/// The solution's covariance from what it does when each stretch of `segment_s` seconds is left out in turn (jackknife,
/// linearised; CR3 in the words of Bell and McCaffrey 2002). Errors that are correlated within a stretch do not make
/// the result look better than it is, and few stretches make it look worse. A sandwich of the stretches' gradients
/// would do the opposite: their sum is zero at the solution, and of one stretch so is the sigma. Where there are fewer
/// than kFewestStretches, the time is cut into as many.
///
/// `J`, `r`: Jacobian and residuals at the solution; `time_s`: of each residual, ascending. Directions that no residual
/// sees count as zero.
StretchCovariance stretch_covariance(const ceres::CRSMatrix& J, const std::vector<double>& r,
                                     const std::vector<double>& time_s, double segment_s);

}  // namespace foresight
