#include "calibration/camera/lens_slopes.hpp"

#include <gtest/gtest.h>

namespace foresight::lens_slopes_test {
namespace {

LensParameters lens_of(Distortion distortion) {
  LensParameters lens{500, 510, 320, 240};
  const std::vector<int> free = free_parameters(distortion);
  for (std::size_t i = 4; i < free.size(); ++i) lens[i] = 0.02 / static_cast<double>(i);
  return lens;
}

Eigen::Vector2d pixel_of(Distortion distortion, const LensParameters& lens, const Eigen::Vector3d& p) {
  Eigen::Vector2d pixel;
  EXPECT_TRUE(project(distortion, lens.data(), p, pixel));
  return pixel;
}

class LensSlopesTest : public testing::TestWithParam<Distortion> {};

TEST_P(LensSlopesTest, AreThoseOfTheProjection) {
  const LensParameters lens = lens_of(GetParam());
  const Eigen::Vector3d p(0.3, -0.2, 0.9);
  Eigen::Vector2d pixel;
  LensSlopes slopes;
  ASSERT_TRUE(project_with_slopes(GetParam(), lens.data(), p, pixel, slopes));
  EXPECT_EQ(pixel, pixel_of(GetParam(), lens, p));
  constexpr double kStep = 1e-6;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d d = kStep * Eigen::Vector3d::Unit(axis);
    const Eigen::Vector2d slope = (pixel_of(GetParam(), lens, p + d) - pixel_of(GetParam(), lens, p - d)) / (2 * kStep);
    EXPECT_LT((slopes.point.col(axis) - slope).norm(), 1e-5 * (1 + slope.norm())) << axis;
  }
  for (int i = 0; i < kLensParameters; ++i) {
    LensParameters more = lens, less = lens;
    more[static_cast<std::size_t>(i)] += kStep, less[static_cast<std::size_t>(i)] -= kStep;
    const Eigen::Vector2d slope = (pixel_of(GetParam(), more, p) - pixel_of(GetParam(), less, p)) / (2 * kStep);
    EXPECT_LT((slopes.lens.col(i) - slope).norm(), 1e-5 * (1 + slope.norm())) << i;
  }
}

TEST_P(LensSlopesTest, ChainToWhatTheModelGivesByItself) {
  // Point and lens that depend on four unknowns.
  using Jet = ceres::Jet<double, 4>;
  const LensParameters values = lens_of(GetParam());
  std::array<Jet, kLensParameters> lens;
  for (int i = 0; i < kLensParameters; ++i) {
    lens[static_cast<std::size_t>(i)] = Jet(values[static_cast<std::size_t>(i)]);
    lens[static_cast<std::size_t>(i)].v = Eigen::Vector4d(0.1 * i, -0.2, 0.3, i % 3);
  }
  Eigen::Matrix<Jet, 3, 1> p;
  for (int i = 0; i < 3; ++i) p[i] = Jet(std::array{0.3, -0.2, 0.9}[static_cast<std::size_t>(i)], i);
  Eigen::Matrix<Jet, 2, 1> whole, chained, of_known;
  ASSERT_TRUE(project(GetParam(), lens.data(), p, whole));
  ASSERT_TRUE(project_by_slopes(GetParam(), lens.data(), p, chained));
  ASSERT_TRUE(project_by_slopes(GetParam(), values, p, of_known));
  for (Jet& l : lens) l.v.setZero();
  Eigen::Matrix<Jet, 2, 1> whole_of_known;
  ASSERT_TRUE(project(GetParam(), lens.data(), p, whole_of_known));
  for (int row = 0; row < 2; ++row) {
    EXPECT_DOUBLE_EQ(chained[row].a, whole[row].a);
    EXPECT_LT((chained[row].v - whole[row].v).norm(), 1e-11 * whole[row].v.norm());
    EXPECT_LT((of_known[row].v - whole_of_known[row].v).norm(), 1e-11 * whole_of_known[row].v.norm());
  }
}

INSTANTIATE_TEST_SUITE_P(Models, LensSlopesTest,
                         testing::Values(Distortion::radtan4, Distortion::radtan5, Distortion::rational,
                                         Distortion::thin_prism, Distortion::equidistant),
                         [](const auto& model) {
                           std::string name = to_string(model.param);
                           std::erase(name, '-');
                           return name;
                         });

TEST(LensSlopes, NothingBehindTheCamera) {
  Eigen::Vector2d pixel;
  LensSlopes slopes;
  const LensParameters lens = lens_of(Distortion::radtan4);
  EXPECT_FALSE(project_with_slopes(Distortion::radtan4, lens.data(), {0, 0, -1}, pixel, slopes));
}

}  // namespace
}  // namespace foresight::lens_slopes_test
