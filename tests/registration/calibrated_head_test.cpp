#include "calibration/registration/calibrated_head.hpp"

#include "calibration/result/result_file.hpp"
#include "calibration/robot/robot_results.hpp"
#include "lab_head.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::calibrated_head_test {
namespace {

using testing::HasSubstr;

PanTiltModel some_head() {
  PanTiltModel model;
  model.T_world_pan = to_motion((Vector6d() << 0.3, -0.2, 1.1, 0.4, 0.5, 0.6).finished());
  model.length_m = 0.013, model.twist_rad = 1.52;
  model.T_tilt_camera = to_motion((Vector6d() << -0.1, 0.8, 0.2, 0.03, -0.02, 0.05).finished());
  model.gain = {1.004, 0.997};
  model.backlash_rad = {-0.003, 0.002};  // the shaft lags; the encoder lags
  return model;
}

/// Both joints travel from `from` to `to`, far beyond the play; the answer is where they end.
Pose after_travel(const HeadModel& head, const HeadAngles& from, const HeadAngles& to) {
  EncoderTrack track(head, {});
  RobotTime time;
  for (int i = 0; i <= 20; ++i) {
    const double s = i / 20.0;
    time = RobotTime{} + seconds(0.01 * i);
    track.add(time, {from.pan + s * (to.pan - from.pan), from.tilt + s * (to.tilt - from.tilt)});
  }
  return T_world_camera(head, track.at(time).shafts);
}

TEST(CalibratedHead, BothModelsGiveTheSamePoseFromEverySide) {
  const PanTiltModel model = some_head();
  const HeadModel head = head_model(model);
  for (const int pan_way : {-1, 1})
    for (const int tilt_way : {-1, 1})
      for (const auto& [pan, tilt] : {std::pair{0.0, 0.0}, {0.7, -0.4}, {-1.2, 0.3}}) {
        const Pose expected = camera_pose(model, {pan, tilt, {pan_way, tilt_way}});
        const Pose found = after_travel(head, {pan - 0.1 * pan_way, tilt - 0.1 * tilt_way}, {pan, tilt});
        EXPECT_LT(to_twist(expected.inverse() * found).norm(), 1e-12) << pan << " " << pan_way << " " << tilt_way;
      }
}

TEST(CalibratedHead, ReadsModelClockAndSigmas) {
  const TempFolder folder;
  PanTiltTagSummary summary;
  summary.model = some_head();
  summary.pose_sigma << 1e-4, 2e-4, 3e-4, 4e-4, 5e-4, 6e-4;
  summary.shaft_rad = 2.5e-4;
  const auto head = folder / "head.yaml", clock = folder / "time.yaml";
  write_result(head, {"pan-tilt", utc_now(), {}, "loo_px", 0.2, {{"offset_s", 0.0004}}}, to_yaml(summary, 0.012),
               false);
  HeadModel read = read_head_model(head, {});
  EXPECT_LT(to_twist(read.T_pan_tilt.inverse() * head_model(summary.model).T_pan_tilt).norm(), 1e-12);
  EXPECT_EQ(read.sigma_pose, summary.pose_sigma);
  EXPECT_EQ(read.sigma_rad, 2.5e-4);
  EXPECT_EQ(read.offset_s, 0.012);
  EXPECT_EQ(read.sigma_offset_s, 0.0004);

  TimeOffsetSummary time;
  time.offset_s = -0.02;
  write_result(clock, {"time", utc_now(), {}, "offset_sigma_s", 0.002, {{"offset_s", 0.002}}}, to_yaml(time), false);
  read = read_head_model(head, clock);
  EXPECT_EQ(read.offset_s, -0.02);
  EXPECT_EQ(read.sigma_offset_s, 0.002);
  EXPECT_THAT(input_error([&] { read_head_model(clock, {}); }), HasSubstr("calibrate pan-tilt"));
  EXPECT_THAT(input_error([&] { read_head_model(head, head); }), HasSubstr("calibrate time"));
}

TEST(CalibratedHead, OfPosesGivesItsLeftOutErrorAsSigma) {
  const TempFolder folder;
  write_result(folder / "head.yaml", {"pan-tilt", utc_now(), {}, "loo_mrad", 1.7, {}}, to_yaml(some_head()), false);
  EXPECT_NEAR(read_head_model(folder / "head.yaml", {}).sigma_pose[1], 1.7e-3 / std::sqrt(3), 1e-12);
}

}  // namespace
}  // namespace foresight::calibrated_head_test
