#include <ceres/gradient_checker.h>
#include <gtest/gtest.h>

#include "calibration/camera/corner_residual.hpp"
#include "calibration/camera/rigid_motion.hpp"
#include "tests/camera_calibration/synthetic_rig.hpp"

namespace foresight::residual_test {
namespace {

class Residual : public testing::TestWithParam<Distortion> {};

TEST_P(Residual, DerivativesMatchDifferences) {
  const auto s = test::synthetic_rig(
      3, {.views = 1,
          .distortion = GetParam() == Distortion::equidistant ? Distortion::equidistant : Distortion::radtan4});
  CameraModel camera = s.rig.cameras[1];
  if (GetParam() == Distortion::rational || GetParam() == Distortion::thin_prism)
    camera.lens[9] = 0.05, camera.lens[10] = 0.02, camera.lens[11] = -0.01;
  if (GetParam() == Distortion::thin_prism) camera.lens[12] = 0.002, camera.lens[15] = -0.001;
  auto T_left_board = to_parameters(s.T_left_board[0]);
  auto T_left_right = to_parameters(s.rig.T_left_right);
  std::array<double, 2> warp{0.001, -0.002};
  const Corner corner = s.views.views[0].corners[1][20];
  const std::unique_ptr<ceres::CostFunction> cost(
      corner_cost({GetParam(), s.views.p_board[20], {0.3, 0.7}, corner.pixel, 2.5, true}));
  const std::unique_ptr<ceres::Manifold> motion(motion_manifold());
  const std::vector<const ceres::Manifold*> manifolds{nullptr, motion.get(), nullptr, motion.get()};
  ceres::NumericDiffOptions numeric;
  numeric.ridders_relative_initial_step_size = 1e-3;
  const ceres::GradientChecker checker(cost.get(), &manifolds, numeric);
  const double* parameters[] = {camera.lens.data(), T_left_board.data(), warp.data(), T_left_right.data()};
  ceres::GradientChecker::ProbeResults results;
  EXPECT_TRUE(checker.Probe(parameters, 1e-5, &results)) << results.error_log;
}

INSTANTIATE_TEST_SUITE_P(Models, Residual,
                         testing::Values(Distortion::radtan4, Distortion::radtan5, Distortion::rational,
                                         Distortion::thin_prism, Distortion::equidistant),
                         [](const auto& which) {
                           std::string name = to_string(which.param);
                           std::erase(name, '-');
                           return name;
                         });

TEST(Unproject, IsTheInverseOfProject) {
  for (const Distortion distortion : {Distortion::radtan4, Distortion::equidistant}) {
    std::mt19937 random(5);
    const CameraModel camera = test::random_camera(random, distortion);
    for (const Eigen::Vector2d& pixel :
         {Eigen::Vector2d(319.5, 239.5), {0, 0}, {639, 10}, {camera.lens[2], camera.lens[3]}}) {
      const auto ray = unproject(camera, pixel);
      ASSERT_TRUE(ray);
      EXPECT_LT((*project(camera, *ray) - pixel).norm(), 1e-8);
    }
  }
}

}  // namespace
}  // namespace foresight::residual_test
