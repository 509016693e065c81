#include "common/rotation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

namespace foresight::rotation_test {
namespace {

Eigen::Matrix3d some_rotation(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized().matrix();
}

TEST(NearestRotation, IsTheRotationWithinADistortedOne) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Eigen::Matrix3d R = some_rotation(seed), S = some_rotation(seed + 100);
    // R times a symmetric positive matrix: its polar factor is R.
    const Eigen::Matrix3d M = R * S * Eigen::Vector3d(3, 1, 0.2).asDiagonal() * S.transpose();
    EXPECT_LT((nearest_rotation(M) - R).norm(), 1e-12);
  }
}

TEST(NearestRotation, NeverMirrors) {
  const Eigen::Matrix3d mirrored = some_rotation(1) * Eigen::Vector3d(1, 1, -0.1).asDiagonal();
  const Eigen::Matrix3d R = nearest_rotation(mirrored);
  EXPECT_NEAR(R.determinant(), 1, 1e-12);
  EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_LT((R - some_rotation(1)).norm(), 1e-9) << "the weakest direction gives way";
}

TEST(NearestRotation, AlignsVectorsOfAPlane) {
  const Eigen::Matrix3d R = some_rotation(7);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& a : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(1, 2, 0), Eigen::Vector3d(-1, 1, 0)})
    sum += (R * a) * a.transpose();
  EXPECT_LT((nearest_rotation(sum) - R).norm(), 1e-12);
}

TEST(PrincipalLengths, AreSingularValues) {
  const Eigen::Matrix3d U = some_rotation(3);
  const Eigen::Vector3d lengths(5, 2, 0);
  const Eigen::Matrix3d scatter = U * lengths.cwiseAbs2().asDiagonal() * U.transpose();
  const Eigen::Vector3d got = principal_lengths(scatter);
  EXPECT_NEAR(got[0], 5, 1e-12);
  EXPECT_NEAR(got[1], 2, 1e-12);
  EXPECT_NEAR(got[2], 0, 5e-8) << "the root of rounding";
}

TEST(PrincipalLengths, OfThePlaneAreThoseInSpace) {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  scatter.topLeftCorner<2, 2>() << 2, 0.7, 0.7, 0.5;
  const Eigen::Vector2d got = principal_lengths(Eigen::Matrix2d(scatter.topLeftCorner<2, 2>()));
  EXPECT_LT((got - principal_lengths(scatter).head<2>()).norm(), 1e-12);
}

}  // namespace
}  // namespace foresight::rotation_test
