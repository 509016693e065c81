#include "calibration/robot/pan_tilt.hpp"
#include "calibration/result/result_file.hpp"

#include "calibration/robot/robot_results.hpp"
#include "synthetic_rig.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::pan_tilt_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

double worst_prediction(const PanTiltModel& a, const PanTiltModel& b) {
  double worst = 0;
  for (double pan = -1.5; pan < 1.6; pan += 0.5)
    for (double tilt = -0.8; tilt < 0.9; tilt += 0.4)
      for (const int way : {-1, 1})
        worst = std::max(
            worst,
            step_between(camera_pose(a, {pan, tilt, {way, way}}), camera_pose(b, {pan, tilt, {way, way}})).norm());
  return worst;
}

TEST(PanTilt, RecoversTheHeadFromEveryOrientation) {
  Random random(41);
  for (int i = 0; i < 10; ++i) {
    const PanTiltModel truth = random_head(random);
    std::vector<PanTiltSample> samples = make_head(random, truth, 40, 0, 0);
    const bool inverted = i % 2 == 1;
    if (inverted)
      for (PanTiltSample& sample : samples) sample.T_world_camera = sample.T_world_camera.inverse();
    PanTiltOptions options;
    options.score = false;
    const PanTiltSummary summary = solve_pan_tilt(samples, options);
    EXPECT_EQ(summary.inverted, inverted);
    EXPECT_LT(worst_prediction(summary.model, truth), 1e-6);
  }
}

TEST(PanTilt, RobustFitBearsWildPosesThatPlainLeastSquaresDoesNot) {
  Random random(42);
  const PanTiltModel truth = random_head(random);
  std::vector<PanTiltSample> samples = make_head(random, truth, 60, 1e-3, 5e-4);
  for (const std::size_t i : {7u, 30u, 44u})
    samples[i].T_world_camera = samples[i].T_world_camera * random_pose(random, 0.5, 0.1);
  PanTiltOptions options;
  options.score = false;
  const PanTiltSummary robust = solve_pan_tilt(samples, options);
  options.robust = false;
  const PanTiltSummary plain = solve_pan_tilt(samples, options);
  EXPECT_LT(worst_prediction(robust.model, truth), 4e-3);
  EXPECT_LT(worst_prediction(robust.model, truth), 0.5 * worst_prediction(plain.model, truth));
  EXPECT_EQ(robust.outliers, 3);
  EXPECT_NEAR(robust.sigma_mrad, 1, 0.3);
}

TEST(PanTilt, NamesTheMissingMotion) {
  Random random(43);
  std::vector<PanTiltSample> samples = make_head(random, random_head(random), 20, 0, 0);
  for (PanTiltSample& sample : samples) sample.angles.tilt = 0.3;
  EXPECT_THAT(input_error([&] { solve_pan_tilt(samples, {}); }),
              AllOf(HasSubstr("only the pan joint moved"), HasSubstr("4 of 14"), HasSubstr("tilt")));
  for (PanTiltSample& sample : samples) sample.angles.pan = 0;
  EXPECT_THAT(input_error([&] { solve_pan_tilt(samples, {}); }), HasSubstr("neither joint moved"));
  samples.resize(5);
  EXPECT_THAT(input_error([&] { solve_pan_tilt(samples, {}); }), HasSubstr("5 poses"));
}

TEST(PanTilt, RefusesAnglesOfAnotherSession) {
  Random random(44);
  std::vector<PanTiltSample> samples = make_head(random, random_head(random), 30, 0, 0);
  std::vector<PanTiltSample> other = make_head(random, random_head(random), 30, 0, 0);
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i].angles = other[i].angles;
  EXPECT_THAT(input_error([&] { solve_pan_tilt(samples, {}); }), HasSubstr("no two-axis head fits"));
}

TEST(PanTilt, ReadsTheWaysFromTheOrder) {
  std::vector<PanTiltSample> samples(5);
  const double pan[] = {0, 1, 1, 0.5, 0.7};
  for (std::size_t i = 0; i < 5; ++i) samples[i].angles.pan = pan[i];
  came_from_order(samples);
  const int ways[] = {0, 1, 1, -1, 1};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(samples[i].angles.came[0], ways[i]) << i;
}

TEST(PanTilt, BacklashNeedsBothWays) {
  Random random(45);
  std::vector<PanTiltSample> samples = make_head(random, random_head(random), 30, 1e-4, 1e-4);
  for (PanTiltSample& sample : samples) sample.angles.came[0] = 1;
  PanTiltOptions options;
  options.score = false;
  const PanTiltSummary summary = solve_pan_tilt(samples, options);
  EXPECT_THAT(summary.notes, testing::Contains(HasSubstr("pan backlash stays open")));
  EXPECT_EQ(summary.model.backlash_rad[0], 0);
  EXPECT_NE(summary.model.backlash_rad[1], 0);
}

TEST(PanTilt, FileReadsBack) {
  Random random(46);
  PanTiltModel model = random_head(random);
  model.gain = {1.001, 0.998};
  TempFolder folder;
  write_result(folder / "head.yaml", {"pan-tilt", utc_now(), {}, "loo_mrad", 1, {}}, to_yaml(model), false);
  const PanTiltModel read = read_pan_tilt(read_result(folder / "head.yaml", "pan-tilt").result);
  EXPECT_LT(worst_prediction(read, model), 1e-12);
}

}  // namespace
}  // namespace foresight::pan_tilt_test
