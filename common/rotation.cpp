#include "common/rotation.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <cmath>

namespace foresight {

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& M) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d &U = svd.matrixU(), &V = svd.matrixV();
  // Where that would mirror, the direction that matters least is turned round.
  const Eigen::Vector3d signs(1, 1, U.determinant() * V.determinant());
  return U * signs.asDiagonal() * V.transpose();
}

Eigen::Vector3d principal_lengths(const Eigen::Matrix3d& scatter) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().reverse().cwiseMax(0).cwiseSqrt();
}

Eigen::Vector2d principal_lengths(const Eigen::Matrix2d& scatter) {
  const double middle = scatter.trace() / 2, half_way = std::hypot((scatter(0, 0) - scatter(1, 1)) / 2, scatter(0, 1));
  return Eigen::Vector2d(middle + half_way, middle - half_way).cwiseMax(0).cwiseSqrt();
}

bool is_rigid(const Eigen::Isometry3d& T, double tolerance) {
  const Eigen::Matrix3d R = T.linear();
  return T.matrix().allFinite() &&
         (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= tolerance && R.determinant() > 0;
}

}  // namespace foresight
