// From where, and with everything where, the robot's future is drawn.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "display/frame_source.hpp"
#include "prediction/robot_future.hpp"
#include "rig/rig.hpp"
#include "session/live_scene.hpp"

namespace foresight {

/// By the kinematics of the rig's head alone, the left camera for given joints; nothing where the rig has no head whose
/// place is known.
using HeadPose = std::function<std::optional<Pose>(const JointPositions&)>;
/// Of a calibrated head, or of the mock lab's by its drawing. Throws what read_head_model() does.
HeadPose head_pose_of(const Rig& rig, const LiveScene& scene);

/// Positions by name, with the mock lab's names of the head.
JointPositions positions_of(const Rig& rig, const JointValues& positions);

/// One thread. `rig` must outlive this.
class PredictedPlaces {
 public:
  PredictedPlaces(const Rig& rig, std::shared_ptr<const LiveScene> scene);

  /// A frame came: where the camera truly was when the head stood so. What the registration saw of the head's errors
  /// is taken along into the future.
  void saw(const PosedImage& frame, const JointPositions& joints);
  /// Where the left camera and all nodes will be. A robot that is `invalid` stands as it was last measured.
  ViewPlace place(const PredictedRobot& robot) const;
  /// There is something to go by.
  bool knows_camera() const { return head_ || seen_; }

 private:
  const Rig& rig_;
  std::shared_ptr<const LiveScene> scene_;
  HeadPose head_;
  std::optional<Pose> seen_;             // without a head: where it was last
  Pose T_head_seen_ = Pose::Identity();  // head_(q)^-1 * seen, of the last frame
};

}  // namespace foresight
