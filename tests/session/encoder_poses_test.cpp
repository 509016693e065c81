#include "session/encoder_poses.hpp"

#include "sim/pan_tilt_head.hpp"
#include "sim/synth_run.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/folders.hpp"

namespace foresight::encoder_poses_test {
namespace {

using namespace std::chrono_literals;

constexpr double kSpeed = 1;  // rad/s, of the pan joint

class Encoders : public testing::Test {
 protected:
  RobotTime at(Duration time) const { return RobotTime{1'000'000'000} + time; }
  double pan_at(RobotTime time) const { return kSpeed * to_seconds(time - at(0ms)) - 0.5; }

  /// A cycle at `time` in which each joint's position is of another instant: joint j's of j milliseconds before.
  RobotCycle cycle(Duration time, bool homed = true) const {
    RobotCycle out;
    out.time = at(time);
    out.all_homed = homed;
    out.joints = rig_.joints.size();
    for (std::size_t j = 0; j < out.joints; ++j) {
      out.joint[j].homed = homed;
      out.joint[j].time = out.time - Duration(std::chrono::milliseconds(j));
      const bool pan = rig_.joints[j].drive.name == "pan";
      out.joint[j].position = pan ? pan_at(out.joint[j].time) : 0.01;
    }
    return out;
  }
  void run(Duration from, Duration to, bool homed = true) {
    for (Duration t = from; t <= to; t += 4ms) ring_.put(cycle(t, homed));
  }
  StereoPair pair(Duration left, Duration right) const {
    const auto image = [&](Duration time, const Lens& lens) {
      return ColourImage{cv::Mat(lens.height(), lens.width(), CV_8UC3, cv::Scalar::all(90)), 0, at(time), {}};
    };
    return {image(left, lenses_.left), image(right, lenses_.right)};
  }
  Pose T_world_left(Duration time) const { return sim::T_world_head_left({pan_at(at(time)), 0.01}); }
  std::shared_ptr<const LiveScene> mock() const {
    return std::make_shared<const LiveScene>(std::make_shared<const sim::LiveLab>(sim::LiveLab::Options{.texel = 0.02}),
                                             lenses_);
  }
  /// The lab's head by its drawing, as a result of `calibrate pan-tilt`.
  void calibrate(double offset_s = 0) {
    rig_.calibration = RigCalibration{
        folder_.write("head.yaml",
                      "kind: pan-tilt\ndate: 2026-01-01T00:00:00Z\nscore: {name: loo_mrad, value: 0.5}\nresult:\n"
                      "  T_world_pan: {xyz: [-0.82, 0.04, 0.48], quaternion: [0, 0, 0, 1]}\n"
                      "  length_m: 0\n  twist_rad: -1.5707963267948966\n"
                      "  T_tilt_camera: {xyz: [0.03, 0, 0.0325], quaternion: [0, 0.70710678118654752, 0, "
                      "0.70710678118654752]}\n"
                      "  gain: [1, 1]\n  backlash_rad: [0, 0]\n  offset_s: " +
                          std::to_string(offset_s) + "\n"),
        {},
        {}};
  }

  const TempFolder folder_;
  Rig rig_ = read_rig(source_folder() / "configs/minerva.yaml");
  StereoLenses lenses_ = [] {
    sim::SynthOptions small;
    small.width = 64, small.height = 48;
    return StereoLenses{sim::synth_lens(small, false), sim::synth_lens(small, true), sim::T_head_left_right()};
  }();
  BroadcastRing<RobotCycle> ring_{1024};
};

TEST_F(Encoders, EachJointIsTakenAtItsOwnInstants) {
  JointTracks joints(rig_.joints.size());
  for (Duration t = 0ms; t <= 100ms; t += 4ms) joints.add(cycle(t));
  const JointState state = joints.at(at(50ms));
  EXPECT_EQ(state.status, StateStatus::interpolated);
  EXPECT_NEAR(state.positions[8], pan_at(at(50ms)), 1e-12) << "by the cycle's time it would be 8 mrad off";
  EXPECT_TRUE(joints.know(at(91ms)));
  EXPECT_FALSE(joints.know(at(92ms))) << "the last joint's newest word is of 91 ms";
}

TEST_F(Encoders, BeforeTheyAreHomedTheyTellNothing) {
  JointTracks joints(rig_.joints.size());
  for (Duration t = 0ms; t <= 100ms; t += 4ms) joints.add(cycle(t, false));
  EXPECT_EQ(joints.at(at(50ms)).status, StateStatus::invalid);
}

TEST_F(Encoders, PlaceMockCamerasByTheLabsDrawing) {
  EncoderPoses poses(rig_, mock(), ring_.reader());
  EXPECT_TRUE(poses.has_poses());
  run(0ms, 60ms);
  EXPECT_FALSE(poses.is_ready(pair(56ms, 56ms)));
  run(64ms, 100ms);
  const StereoPair taken = pair(56ms, 61ms);
  EXPECT_TRUE(poses.is_ready(taken));
  const PairPoses found = poses.poses_of(taken);
  EXPECT_EQ(found.quality, "encoders");
  EXPECT_FALSE(found.predicted_px);
  EXPECT_TRUE((*found.T_world_camera)[0].isApprox(T_world_left(56ms), 1e-9));
  EXPECT_TRUE((*found.T_world_camera)[1].isApprox(T_world_left(61ms) * sim::T_head_left_right(), 1e-9))
      << "the right image has an instant of its own";
  EXPECT_EQ(found.scene[0].time, at(56ms));
  EXPECT_EQ(found.scene[1].time, at(61ms));
  EXPECT_FALSE(found.scene[0].T_world_node.empty());
  EXPECT_NEAR(found.joints.positions[8], pan_at(at(56ms)), 1e-12);
}

TEST_F(Encoders, WhatTheyDoNotKnowIsLost) {
  EncoderPoses poses(rig_, mock(), ring_.reader());
  run(0ms, 100ms, false);
  EXPECT_EQ(poses.poses_of(pair(50ms, 50ms)).quality, "lost") << "not homed";
  run(1000ms, 1100ms);
  EXPECT_EQ(poses.poses_of(pair(900ms, 900ms)).quality, "lost") << "before the first";
  const PairPoses late = poses.poses_of(pair(1300ms, 1300ms));
  EXPECT_EQ(late.quality, "lost") << "long after the last";
  EXPECT_FALSE(late.T_world_camera);
}

// Its last word is long past, or it never had one: the cameras stand where their own joints say.
TEST_F(Encoders, ADeadGripperLosesNoFrame) {
  for (const bool calibrated : {false, true})
    for (const bool ever : {true, false}) {
      SCOPED_TRACE(std::string(calibrated ? "calibrated" : "by drawing") + (ever ? ", died" : ", never lived"));
      if (calibrated) calibrate();
      BroadcastRing<RobotCycle> ring(1024);
      EncoderPoses poses(rig_, mock(), ring.reader());
      for (Duration t = 0ms; t <= 1000ms; t += 4ms) {
        RobotCycle now = cycle(t);
        now.all_homed = false;
        if (t > 100ms || !ever) now.joint[7].homed = false;
        ring.put(now);
      }
      const StereoPair taken = pair(956ms, 961ms);
      EXPECT_TRUE(poses.is_ready(taken)) << "nobody waits for it";
      const PairPoses found = poses.poses_of(taken);
      EXPECT_EQ(found.quality, "encoders");
      ASSERT_TRUE(found.T_world_camera);
      EXPECT_TRUE((*found.T_world_camera)[0].isApprox(T_world_left(956ms), 1e-9));
      EXPECT_EQ(found.missing, "finger");
      EXPECT_EQ(found.scene[0].status, StateStatus::predicted);
      EXPECT_EQ(found.joints.status, StateStatus::invalid) << "who needs all joints must know";
      EXPECT_EQ(std::isfinite(found.joints.positions[7]), ever);
    }
}

TEST_F(Encoders, ADeadHeadLosesThem) {
  EncoderPoses poses(rig_, mock(), ring_.reader());
  for (Duration t = 0ms; t <= 1000ms; t += 4ms) {
    RobotCycle now = cycle(t);
    if (t > 100ms) now.joint[8].homed = false;
    ring_.put(now);
  }
  EXPECT_EQ(poses.poses_of(pair(956ms, 961ms)).quality, "lost");
}

TEST_F(Encoders, PlaceTheCamerasOfACalibratedHead) {
  calibrate(0.02);
  EncoderPoses poses(rig_, mock(), ring_.reader());
  run(0ms, 200ms);
  const PairPoses found = poses.poses_of(pair(100ms, 105ms));
  EXPECT_EQ(found.quality, "encoders");
  EXPECT_TRUE(found.predicted_px);
  EXPECT_EQ(found.joints.time, at(120ms)) << "at the calibrated offset";
  EXPECT_TRUE((*found.T_world_camera)[0].isApprox(T_world_left(120ms), 1e-9));
  EXPECT_TRUE((*found.T_world_camera)[1].isApprox(T_world_left(125ms) * sim::T_head_left_right(), 1e-9));
}

TEST_F(Encoders, RealCamerasWithoutACalibrationAreNowhere) {
  const auto scene = std::make_shared<const LiveScene>(StereoConfig{}, &rig_, std::nullopt);
  EncoderPoses poses(rig_, scene, ring_.reader());
  EXPECT_FALSE(poses.has_poses());
  run(0ms, 100ms);
  const PairPoses found = poses.poses_of(pair(50ms, 50ms));
  EXPECT_EQ(found.quality, "none");
  EXPECT_FALSE(found.T_world_camera);
  EXPECT_EQ(found.joints.status, StateStatus::interpolated) << "the joints are known all the same";
  calibrate();
  EXPECT_THAT(input_error([&] { EncoderPoses(rig_, scene, ring_.reader()); }),
              says("head.yaml", "lenses are not calibrated", "lens"));
}

}  // namespace
}  // namespace foresight::encoder_poses_test
