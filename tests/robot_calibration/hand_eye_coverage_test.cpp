// Standard deviations mean what they say, over many random rigs.
#include <gtest/gtest.h>

#include "calibration/robot/pan_tilt.hpp"
#include "calibration/robot/time_offset.hpp"
#include "synthetic_rig.hpp"

namespace foresight::hand_eye_coverage_test {
namespace {

struct Count {
  int inside = 0, all = 0;
  void add(double in_sigmas) {
    ++all;
    inside += std::abs(in_sigmas) < 2;
  }
  double share() const { return static_cast<double>(inside) / all; }
};

// 92 to 98 % over 200 rigs; the few of a short run scatter more.
void expect_honest(const Count& count) {
  testing::Test::RecordProperty("share", std::to_string(count.share()));
  std::printf("inside 2 sigma: %d of %d = %.3f\n", count.inside, count.all, count.share());
  EXPECT_GE(count.share(), long_run() ? 0.92 : 0.85);
  EXPECT_LE(count.share(), long_run() ? 0.98 : 1);
}

TEST(Coverage, HandEye) {
  Random random(21);
  Count count;
  HandEyeOptions options;
  options.score = false;
  for (int i = 0; i < (long_run() ? 200 : 8); ++i) {
    const HandEyeRig rig =
        make_rig(random, {.mount = i % 2 == 0 ? CameraMount::fixed : CameraMount::moving, .views = 16});
    const HandEyeSummary summary = solve_hand_eye(rig.data, options);
    for (const double off : in_sigmas(summary.X, rig.X, summary.X_sigma)) count.add(off);
    for (const double off : in_sigmas(summary.Y, rig.Y, summary.Y_sigma)) count.add(off);
    for (std::size_t k = 0; k < 4; ++k)
      count.add((summary.camera.lens[k] - rig.camera.lens[k]) / summary.lens_sigma[k]);
  }
  expect_honest(count);
}

TEST(Coverage, TimeOffset) {
  Random random(22);
  Count count;
  for (int i = 0; i < (long_run() ? 200 : 8); ++i) {
    const StreamRig rig = make_streams(random, 40, std::uniform_real_distribution<double>(-0.3, 0.3)(random));
    const TimeOffsetSummary summary = solve_time_offset(rig.encoder, rig.camera, {});
    count.add((summary.offset_s - rig.offset_s) / summary.offset_sigma_s);
    for (const double off : in_sigmas(summary.X, rig.X, summary.X_sigma)) count.add(off);
  }
  expect_honest(count);
}

TEST(Coverage, PanTilt) {
  Random random(23);
  Count count;
  PanTiltOptions options;
  options.score = false;
  for (int i = 0; i < (long_run() ? 200 : 8); ++i) {
    const PanTiltModel truth = random_head(random);
    const PanTiltSummary summary = solve_pan_tilt(make_head(random, truth, 60, 1e-3, 5e-4), options);
    const auto sigma = [&](const std::string& name) {
      for (std::size_t k = 0; k < summary.names.size(); ++k)
        if (summary.names[k] == name) return summary.sigmas[k];
      return 0.0;
    };
    count.add((std::abs(summary.model.length_m) - std::abs(truth.length_m)) / sigma("length_m"));
    for (std::size_t k = 0; k < 2; ++k)
      count.add((summary.model.backlash_rad[k] - truth.backlash_rad[k]) /
                sigma(k == 0 ? "backlash_pan_rad" : "backlash_tilt_rad"));
    const bool flipped = summary.model.length_m * truth.length_m < 0;
    if (flipped) continue;  // the same head with its common normal pointing the other way
    count.add((summary.model.twist_rad - truth.twist_rad) / sigma("twist_rad"));
    Vector6d world, camera;
    for (int k = 0; k < 6; ++k)
      world[k] = summary.sigmas[static_cast<std::size_t>(k)],
      camera[k] = summary.sigmas[static_cast<std::size_t>(8 + k)];
    for (const double off : in_sigmas(summary.model.T_world_pan, truth.T_world_pan, world)) count.add(off);
    for (const double off : in_sigmas(summary.model.T_tilt_camera, truth.T_tilt_camera, camera)) count.add(off);
  }
  expect_honest(count);
}

}  // namespace
}  // namespace foresight::hand_eye_coverage_test
