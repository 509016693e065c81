// Poses of recorded pairs from the calibrated head: encoders at the calibrated offset, and tags in view.
#pragma once

#include <deque>
#include <memory>
#include <mutex>

#include "calibration/registration/registration.hpp"
#include "drivers/robot/robot.hpp"
#include "rig/rig.hpp"
#include "session/run_recorder.hpp"

namespace foresight {

/// Encoders from one thread, pairs from another: nothing that registers ever holds up the ones that deliver encoders,
/// the control loop and the cameras.
class HeadRegistration {
 public:
  /// Reads the rig's calibration, which has a pan_tilt. Throws InputError naming the file that is of another kind or
  /// damaged.
  HeadRegistration(const Rig& rig, const StereoLenses& lenses);

  /// Of the head's joints, once all are homed; a state that was added already is left out.
  void add(const RobotStatus& status);

  /// RecorderOptions::registration: what it returns uses encoders up to now and none that come later, so that a
  /// session in stepped time repeats.
  PairRegistration prepare();

 private:
  struct Row {
    RobotTime time;
    HeadAngles encoders;
  };
  RegisteredPose register_pair(const StereoPair& pair, RobotTime known);

  std::size_t pan_ = 0, tilt_ = 0;  // indices of the rig's joints
  std::mutex mutex_;                // rows_, newest_
  std::deque<Row> rows_;
  RobotTime newest_{INT64_MIN};
  Registration registration_;  // of the thread that registers
};

}  // namespace foresight
