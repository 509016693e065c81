// Poses of a robot's pairs: by its encoders, and by tags in view where its head is calibrated.
#pragma once

#include <memory>
#include <optional>

#include "calibration/registration/registration.hpp"
#include "drivers/robot/robot.hpp"
#include "rig/rig.hpp"
#include "session/joint_tracks.hpp"
#include "session/live_frames.hpp"
#include "session/live_scene.hpp"

namespace foresight {

/// Takes what the control loop hands out when it is asked for a pose. Where the rig's head is calibrated, cameras stand
/// where the registration finds them; mock cameras, else, where the encoders say by the lab's drawing; real ones are
/// nowhere known ("none"). A frame at whose instants the joints that carry the cameras are not known has no poses
/// ("lost"). Other joints that are not known, such as those of a dead gripper, do not matter to the cameras: the
/// model's parts stand where they were last heard of, as `predicted`, and PairPoses::missing names them. One thread.
class EncoderPoses final : public PoseSource {
 public:
  using Cycles = BroadcastRing<RobotCycle>::Reader;

  /// `scene`: not null. `cycles`: Robot::cycles(). `rig` must outlive this. Reads the rig's calibration: throws
  /// InputError naming the file that is of another kind or damaged, and for a calibrated head before cameras without
  /// lenses.
  EncoderPoses(const Rig& rig, std::shared_ptr<const LiveScene> scene, Cycles cycles);

  bool is_ready(const StereoPair& pair) override;
  PairPoses poses_of(const StereoPair& pair) override;
  /// Of the cameras' poses; false: there are none.
  bool has_poses() const { return registration_ || scene_->is_mock(); }

 private:
  void listen();
  RobotTime on_encoders(RobotTime camera_time) const;
  JointPositions by_name(const JointState& joints) const;
  bool cameras_known(const JointState& joints) const;
  SceneState scene_at(RobotTime time, const JointState& joints) const;
  void register_cameras(const StereoPair& pair, PairPoses& out);

  std::shared_ptr<const LiveScene> scene_;
  Cycles cycles_;
  const Rig& rig_;
  std::vector<std::string> names_;
  JointTracks joints_;
  std::size_t pan_ = 0, tilt_ = 0;              // indices of the rig's joints; only with a registration
  std::unique_ptr<Registration> registration_;  // null: the head is not calibrated
};

/// Poses that somebody else gives, such as of a camera that stands still: asked for the instant of each image.
class GivenPoses final : public PoseSource {
 public:
  using At = std::function<Pose(RobotTime)>;
  using Joints = std::function<std::optional<double>(std::string_view joint, RobotTime)>;
  /// `T_world_left`: empty where nobody knows. `joints`: of what moves; may be empty.
  GivenPoses(std::shared_ptr<const LiveScene> scene, At T_world_left, Joints joints = {})
      : scene_(std::move(scene)), T_world_left_(std::move(T_world_left)), joints_(std::move(joints)) {}
  PairPoses poses_of(const StereoPair& pair) override;

 private:
  std::shared_ptr<const LiveScene> scene_;
  At T_world_left_;
  Joints joints_;
};

}  // namespace foresight
