// Rotations from measured directions, points and matrices that are rotations up to rounding.
#pragma once

#include <Eigen/Geometry>

namespace foresight {

/// The rotation (determinant 1) that is closest to `M` in the Frobenius norm. For M = sum of b a^T it is also the one
/// that takes the vectors a to the vectors b with the least squared error (Kabsch 1976; Umeyama 1991, eq. 39).
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& M);

/// Square roots of the eigenvalues of `scatter` = sum of d d^T, largest first: the singular values of the matrix whose
/// columns are the vectors d. Exact to about 1e-8 of the largest.
Eigen::Vector3d principal_lengths(const Eigen::Matrix3d& scatter);
Eigen::Vector2d principal_lengths(const Eigen::Matrix2d& scatter);

/// Of the cross product: cross_matrix(a) * b = a x b.
inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& a) {
  Eigen::Matrix3d out;
  out << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return out;
}

/// All numbers are finite, and the rotation is one: no element of R R^T is farther than `tolerance` from the
/// identity's, and nothing is mirrored.
bool is_rigid(const Eigen::Isometry3d& T, double tolerance = 1e-6);

}  // namespace foresight
