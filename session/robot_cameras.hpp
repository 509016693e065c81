// The cameras of a running robot: real ones, or mock ones that see the emulated drives' shafts; with the poses of their
// pairs for whoever wants them, and recorded on request.
#pragma once

#include <filesystem>
#include <memory>

#include "rig/open_stereo.hpp"
#include "rig/robot_devices.hpp"
#include "session/camera_watch.hpp"
#include "session/encoder_poses.hpp"
#include "session/run_recorder.hpp"

namespace foresight {

/// Names of what is recorded beside the folder OUT: OUT-can.log (OUT-can-BUS.log where there are more) and
/// OUT-joints.csv.
std::filesystem::path can_log_beside(const std::filesystem::path& out);
std::filesystem::path joint_log_beside(const std::filesystem::path& out);

struct RobotCameraOptions {
  bool mock = false;                                 ///< the mock lab's, whatever the rig says
  std::optional<std::filesystem::path> record = {};  ///< folder for a run (RunRecorder) of all pairs
  bool frames = false;                               ///< frames() is wanted; also where it records
  std::optional<std::filesystem::path> scene = {};   ///< in place of the rig's
  bool physics = false;                              ///< of mock cameras: MockWorld::physics, with the rig's gripper
  unsigned physics_seed = 1;                         ///< HiddenPhysics::seed
  unsigned layout = 0;                               ///< MockWorld::layout
  LiveFrameOptions live = {};
};

/// Real cameras are opened when the watch starts. The mock lab is lit at once, which takes seconds of all cores that
/// emulated drives in motion could not spare. `rig` (which has cameras), `devices`, `robot` and `clock` must outlive
/// this.
class RobotCameras {
 public:
  /// Throws what as_mock() does, of mock cameras what open_stereo() and mock_world() do, with frames what LiveScene and
  /// EncoderPoses do, and, where it records, what RunRecorder does, and InputError where a camera's lens is not
  /// calibrated: known before anything moves.
  RobotCameras(const Rig& rig, const RobotDevices& devices, const Robot& robot, Clock& clock,
               const RobotCameraOptions& options);
  ~RobotCameras();

  void start();          ///< threads for the cameras and the registration
  void step() noexcept;  ///< in stepped time, instead of start(): looks at the cameras and registers, without waiting

  const CameraWatch& watch() const { return *watch_; }
  /// Only with RobotCameraOptions::frames or ::record.
  LiveFrames& frames() { return *frames_; }
  const LiveScene& scene() const { return *scene_; }
  /// Where things truly are, in a mock lab with physics; else null.
  const std::shared_ptr<sim::PhysicalLab>& physics() const { return physics_; }
  /// What the newest pair lacks: why it could not be registered at all, or which joints nobody knows; "" where nothing
  /// is amiss, or nobody wants poses.
  std::string registration_trouble() const;

  /// As RunRecorder::fault(); "" without a recording.
  std::string recording_fault() const { return recorder_ ? recorder_->fault() : ""; }

  /// Stops the cameras and the registration, closes all subscribers' queues and finishes the recording. What there is
  /// to say, one line each; empty without a recording. Throws what RunRecorder::finish() does.
  std::string finish();

 private:
  OpenStereo open(const StereoConfig& config) const;
  void add_physics(const StereoConfig& config, unsigned seed);
  void start_recording(const Rig& rig, const std::filesystem::path& out, bool posed);

  const Rig& rig_;
  const RobotDevices& devices_;
  Clock& clock_;
  MockWorld world_;
  OpenStereo ready_;  // until the watch takes the cameras
  std::shared_ptr<sim::PhysicalLab> physics_;
  std::shared_ptr<const LiveScene> scene_;
  std::unique_ptr<LiveFrames> frames_;
  std::unique_ptr<RunRecorder> recorder_;
  std::filesystem::path out_;
  std::unique_ptr<CameraWatch> watch_;  // the last: its thread uses all above
};

}  // namespace foresight
