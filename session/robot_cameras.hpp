// The cameras of a running robot: real ones, or mock ones that see the emulated drives' shafts; recorded on request.
#pragma once

#include <filesystem>
#include <fstream>
#include <memory>

#include "rig/open_stereo.hpp"
#include "rig/robot_devices.hpp"
#include "session/camera_watch.hpp"
#include "session/head_registration.hpp"

namespace foresight {

/// Positions of all joints over time, as --follow reads them: time_s on the robot's clock, then the joints.
class JointLog {
 public:
  /// Throws RuntimeFailure where the file cannot be written.
  JointLog(const std::filesystem::path& file, const Rig& rig);
  /// Of the encoders, once all joints are homed: before, they tell no position. A state that was logged already is left
  /// out.
  void add(const RobotStatus& status);

 private:
  std::ofstream stream_;
  std::size_t joints_;
  RobotTime last_{INT64_MIN};
};

/// Names of what is recorded beside the folder OUT: OUT-can.log (OUT-can-BUS.log where there are more) and
/// OUT-joints.csv.
std::filesystem::path can_log_beside(const std::filesystem::path& out);
std::filesystem::path joint_log_beside(const std::filesystem::path& out);

struct RobotCameraOptions {
  bool mock = false;                            ///< the mock lab's, whatever the rig says
  std::optional<std::filesystem::path> record;  ///< folder for a run (RunRecorder) of all pairs
};

/// Real cameras are opened when the watch starts. The mock lab is lit at once, which takes seconds of all cores that
/// emulated drives in motion could not spare. `rig` (which has cameras), `devices` and `clock` must outlive this.
class RobotCameras {
 public:
  /// Throws what as_mock() does, of mock cameras what open_stereo() and mock_world() do, and, where it records, what
  /// recorder_options(), RunRecorder and HeadRegistration do: known before anything moves.
  RobotCameras(const Rig& rig, const RobotDevices& devices, Clock& clock, const RobotCameraOptions& options);
  ~RobotCameras();

  CameraWatch& watch() { return *watch_; }
  const CameraWatch& watch() const { return *watch_; }
  /// Where the joints are, for the poses of recorded pairs, where the rig's head is calibrated. Any one thread.
  void add_encoders(const RobotStatus& status) {
    if (head_) head_->add(status);
  }
  /// Stops the cameras and finishes the recording. What there is to say, one line each; empty without a recording.
  /// Throws RuntimeFailure where the recording cannot be finished.
  std::string finish();

 private:
  struct Recording;
  OpenStereo open(const StereoConfig& config) const;
  void start_recording(const Rig& rig, const StereoConfig& config, const std::filesystem::path& out);

  const RobotDevices& devices_;
  Clock& clock_;
  MockWorld world_;
  OpenStereo ready_;                        // until the watch takes the cameras
  std::unique_ptr<HeadRegistration> head_;  // outlives the recording, whose thread uses it
  std::unique_ptr<Recording> recording_;
  std::unique_ptr<CameraWatch> watch_;  // the last: its thread uses all above
};

}  // namespace foresight
