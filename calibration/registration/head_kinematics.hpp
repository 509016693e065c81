// The pan-tilt head's kinematics, and its encoders over time.
//
//   T_world_camera = T_world_pan * Rz(pan shaft) * T_pan_tilt * Rz(tilt shaft) * T_tilt_camera
//
// Rz turns about the axis of the frame before it, by the right hand. A shaft stands where its
// encoder says, times `scale`, plus `offset`, and follows with play: it rests until the encoder
// has crossed the backlash (the play operator: shaft in [q - b/2, q + b/2], moved no more than needed). That is
// play between a motor's encoder and the shaft. A negative backlash is play between the shaft and its encoder, which
// then follows: the shaft is as far ahead as it lagged behind before.
#pragma once

#include <deque>

#include "calibration/camera/twist.hpp"
#include "common/time.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

struct HeadAngles {
  double pan = 0;   ///< rad
  double tilt = 0;  ///< rad
};

struct HeadAxis {
  double scale = 1;         ///< shaft per encoder
  double offset_rad = 0;    ///< shaft where the encoder says zero
  double backlash_rad = 0;  ///< full width of the play, in the encoder's angle; below 0: the encoder follows
};

/// What `calibrate pan-tilt` and `calibrate time` find.
struct HeadModel {
  Pose T_world_pan = Pose::Identity();    ///< z: the pan axis
  Pose T_pan_tilt = Pose::Identity();     ///< z: the tilt axis, at pan = 0
  Pose T_tilt_camera = Pose::Identity();  ///< left camera, at tilt = 0
  HeadAxis pan, tilt;
  double offset_s = 0;        ///< t_encoder = t_camera + offset_s
  double sigma_rad = 0.0005;  ///< of each shaft's angle against the model, > 0
  double sigma_offset_s = 0.001;
  /// Of the camera's pose by the model's own errors: rotation vector (rad) and place (m), in the camera's frame.
  Vector6d sigma_pose = Vector6d::Constant(0.01);
};

/// Left camera, by its shafts (not encoders).
Pose T_world_camera(const HeadModel& model, const HeadAngles& shafts);

/// The encoders' recent past. One thread.
class EncoderTrack {
 public:
  struct Options {
    double largest_gap_s = 0.1;  ///< a larger one between two samples is not interpolated
    double most_ahead_s = 0.02;  ///< beyond the newest sample its speed carries on for so long
    double kept_s = 5;
  };
  struct Answer {
    HeadAngles shafts;
    HeadAngles rate;  ///< rad/s
    StateStatus status = StateStatus::invalid;
  };

  EncoderTrack(const HeadModel& model, const Options& options) : model_(model), options_(options) {}

  /// Encoder positions at an instant of the encoders' own stamps. Ignores, and returns false for,
  /// a sample that is not newer than the one before or not finite.
  bool add(RobotTime encoder_time, const HeadAngles& encoders);

  /// Shafts at an image's capture instant; interpolated linearly. `invalid` before the first
  /// sample, in a gap, or too far ahead.
  Answer at(RobotTime camera_time) const;

 private:
  struct Sample {
    RobotTime time;
    HeadAngles shafts;  // with play, scale and offset
  };
  HeadModel model_;
  Options options_;
  std::deque<Sample> samples_;
  HeadAngles played_;  // encoder values behind the play
};

}  // namespace foresight
