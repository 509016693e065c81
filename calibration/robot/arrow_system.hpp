// Covariances of problems with a few shared parameters and many small blocks of their own.
#pragma once

#include <ceres/problem.h>

#include <Eigen/Core>
#include <vector>

namespace foresight {

/// The normal equations [A B; B^T C] of a solved Ceres problem, C one block per own parameter
/// block. Residuals have unit variance, so that inverses are covariances. Tangent coordinates.
struct ArrowSystem {
  Eigen::MatrixXd shared_information;  ///< Schur complement of the own blocks
  Eigen::MatrixXd shared_covariance;   ///< of what is determined; open directions count as zero
  std::vector<Eigen::VectorXd> open;   ///< unit directions of the shared parameters that no residual sees
  std::vector<Eigen::MatrixXd> own_covariance;
  std::vector<Eigen::MatrixXd> own_alone;      ///< covariance of each own block where the shared parameters are known
  std::vector<Eigen::MatrixXd> own_by_shared;  ///< how its estimate moves with the shared parameters: -C^-1 B^T
};

/// `shared` and `own` are parameter blocks that `problem` does not hold constant; own blocks must
/// not meet in one residual.
ArrowSystem arrow_system(ceres::Problem& problem, const std::vector<double*>& shared, const std::vector<double*>& own);

/// Inverse of a symmetric information matrix, scaled to unit diagonal first; directions whose
/// scaled eigenvalue is below `tolerance` go to `open`.
Eigen::MatrixXd invert_information(const Eigen::MatrixXd& information, std::vector<Eigen::VectorXd>& open,
                                   double tolerance = 1e-12);

}  // namespace foresight
