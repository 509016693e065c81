// Of many random rigs, the errors must be as large as the solver says.
#include <gtest/gtest.h>

#include <cstdlib>

#include "calibration/camera/camera_calibration.hpp"
#include "calibration/camera/rig_start.hpp"
#include "tests/camera_calibration/synthetic_rig.hpp"

namespace foresight::synthetic_truth_test {
namespace {

struct Count {
  int inside = 0, all = 0;

  void add(double error, double sigma) {
    ++all;
    inside += std::abs(error) <= 2 * sigma;
  }
};

RigSolution solved(const RigViews& views) {
  RigSolverOptions alone;
  alone.warp = false;
  std::array<RigSolution, 2> cameras;
  for (int c = 0; c < 2; ++c) {
    const CameraViews one = views_of(views, c);
    cameras[std::size_t(c)] = solve_rig(one.views, start_camera(one.views, Distortion::radtan4), alone);
  }
  return solve_rig(views, start_pair(views, cameras[0], cameras[1]), {});
}

TEST(SyntheticTruth, ErrorsLieInsideTwoSigma) {
  const int rigs = std::getenv("FORESIGHT_LONG") ? 200 : 20;
  Count count;
  for (int rig = 0; rig < rigs; ++rig) {
    const auto truth = test::synthetic_rig(1000u + static_cast<unsigned>(rig), {});
    const RigSolution found = solved(truth.views);
    const RigUncertainty uncertainty(truth.views, found, true);
    for (std::size_t c = 0; c < 2; ++c) {
      const LensParameters sigma = uncertainty.lens_sigma(static_cast<int>(c));
      for (const int i : free_parameters(Distortion::radtan4)) {
        const auto k = static_cast<std::size_t>(i);
        count.add(found.rig.cameras[c].lens[k] - truth.rig.cameras[c].lens[k], sigma[k]);
      }
    }
    count.add(found.rig.T_left_right.translation().norm() - truth.rig.T_left_right.translation().norm(),
              uncertainty.baseline_sigma_m());
    count.add(found.rig.warp.x_m, uncertainty.warp_sigma_m().x());
    count.add(found.rig.warp.y_m, uncertainty.warp_sigma_m().y());
  }
  const double share = static_cast<double>(count.inside) / count.all;
  RecordProperty("inside_two_sigma", std::to_string(share));
  std::printf("%d of %d errors inside two sigma: %.1f %%\n", count.inside, count.all, 100 * share);
  // Errors of one rig hang together: 20 rigs scatter more than 200.
  EXPECT_GE(share, rigs == 200 ? 0.92 : 0.90);
  EXPECT_LE(share, rigs == 200 ? 0.98 : 0.99);
}

TEST(SyntheticTruth, FindsAFishEyeByItself) {
  const auto truth = test::synthetic_rig(77, {.views = 12, .distortion = Distortion::equidistant});
  const CameraCalibration c = calibrate_rig(truth.views, subset(truth.views, {}), {});
  EXPECT_EQ(c.solution.rig.cameras[0].distortion, Distortion::equidistant) << c.full();
  EXPECT_NEAR(c.solution.rig.cameras[0].lens[0], 260, 2);
  EXPECT_LT(c.solution.rms_px, 0.32);
}

TEST(SyntheticTruth, FindsTheWarp) {
  auto truth = test::synthetic_rig(78, {.noise_px = 0.05});
  const auto flat = truth.views.p_board;
  const auto bent = warped(flat, {0.002, -0.001});
  for (std::size_t v = 0; v < truth.views.views.size(); ++v)
    for (int c = 0; c < 2; ++c)
      for (Corner& corner : truth.views.views[v].corners[std::size_t(c)]) {
        const auto i = static_cast<std::size_t>(corner.index);
        const auto at = [&](const Eigen::Vector3d& p) {
          return *project(truth.rig.cameras[std::size_t(c)], to_camera(truth.rig, c, truth.T_left_board[v] * p));
        };
        corner.pixel += at(bent[i]) - at(flat[i]);
      }
  const RigSolution found = solved(truth.views);
  EXPECT_NEAR(found.rig.warp.x_m, 0.002, 0.0002);
  EXPECT_NEAR(found.rig.warp.y_m, -0.001, 0.0002);
}

}  // namespace
}  // namespace foresight::synthetic_truth_test
