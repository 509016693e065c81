#include "rig_view/eye.hpp"

#include <gtest/gtest.h>

namespace foresight::eye_test {
namespace {

constexpr int kWidth = 990, kHeight = 860;

/// Through the matrix that the GPU gets.
Eigen::Vector2d through_clip(const Eye& eye, const Eigen::Vector3d& p) {
  const Eigen::Vector4f c = eye.clip_from_world(kWidth, kHeight) * p.cast<float>().homogeneous();
  const double x = static_cast<double>(c.x() / c.w()), y = static_cast<double>(c.y() / c.w());
  return {(x + 1) / 2 * kWidth - 0.5, (y + 1) / 2 * kHeight - 0.5};
}

double depth(const Eye& eye, const Eigen::Vector3d& p) {
  const Eigen::Vector4f c = eye.clip_from_world(kWidth, kHeight) * p.cast<float>().homogeneous();
  return static_cast<double>(c.z() / c.w());
}

TEST(Eye, SeesAllOfABoxFromEverywhere) {
  const Eigen::AlignedBox3d box(Eigen::Vector3d(-0.3, -0.8, 0), Eigen::Vector3d(0.5, 0.4, 1.2));
  for (const LookFrom from : {LookFrom::front, LookFrom::side, LookFrom::top, LookFrom::iso}) {
    const Eye eye = Eye::from(from, box, kWidth / double{kHeight});
    double widest = 0;
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3d corner = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i));
      const auto pixel = eye.pixel(corner, kWidth, kHeight);
      ASSERT_TRUE(pixel);
      EXPECT_GE(pixel->minCoeff(), 0);
      EXPECT_LT(pixel->x(), kWidth);
      EXPECT_LT(pixel->y(), kHeight);
      EXPECT_LT((through_clip(eye, corner) - *pixel).norm(), 0.02) << "words would not stand at their places";
      widest = std::max(
          {widest, std::abs(pixel->x() - kWidth / 2.0) / kWidth, std::abs(pixel->y() - kHeight / 2.0) / kHeight});
    }
    EXPECT_GT(widest, 0.35) << "and fills the picture with it";
  }
}

TEST(Eye, SidesAreWhatTheyAreCalled) {
  const Eigen::AlignedBox3d box(Eigen::Vector3d(-1, -1, -1), Eigen::Vector3d(1, 1, 1));
  const auto moved = [&](LookFrom from, const Eigen::Vector3d& by) {
    const Eye eye = Eye::from(from, box, 1);
    return Eigen::Vector2d(*eye.pixel(by, kHeight, kHeight) - *eye.pixel(Eigen::Vector3d::Zero(), kHeight, kHeight));
  };
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  EXPECT_GT(moved(LookFrom::front, y).x(), 50) << "seen from +x, left is right";
  EXPECT_LT(moved(LookFrom::front, z).y(), -50);
  EXPECT_LT(moved(LookFrom::front, x).norm(), 1) << "without perspective, depth does not show";
  EXPECT_GT(moved(LookFrom::side, x).x(), 50);
  EXPECT_LT(moved(LookFrom::side, y).norm(), 1);
  EXPECT_LT(moved(LookFrom::top, x).y(), -50);
  EXPECT_LT(moved(LookFrom::top, y).x(), -50);
}

TEST(Eye, NearIsInFrontAndMouseMovesWhatItHolds) {
  Eye eye = Eye::from(LookFrom::iso, {Eigen::Vector3d(-1, -1, -1), Eigen::Vector3d(1, 1, 1)}, 1);
  for (const bool perspective : {true, false}) {
    eye.perspective = perspective;
    const Eigen::Vector3d towards = -eye.T_world_eye().linear().col(2);
    EXPECT_GT(depth(eye, 0.5 * towards), depth(eye, -0.5 * towards));
    EXPECT_GT(depth(eye, -0.5 * towards), 0);
    EXPECT_LT(depth(eye, 0.5 * towards), 1);
  }
  const Eigen::Vector3d held = eye.target;
  const Eigen::Vector2d before = *eye.pixel(held, kWidth, kHeight);
  eye.shift(40, -25, kHeight);
  EXPECT_LT((*eye.pixel(held, kWidth, kHeight) - before - Eigen::Vector2d(40, -25)).norm(), 0.5);
  eye.orbit(0, 1e5);
  EXPECT_TRUE(eye.T_world_eye().matrix().allFinite());
  EXPECT_LT(eye.T_world_eye().linear().col(0).z(), 1e-9) << "the horizon stays level";
}

}  // namespace
}  // namespace foresight::eye_test
