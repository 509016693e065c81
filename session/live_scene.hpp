// What live cameras look at, as the robot knows it: lenses, and the model with its nodes that move.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>

#include "calibration/registration/tag_correction.hpp"
#include "rig/open_stereo.hpp"
#include "rig/rig_scene.hpp"

namespace foresight {

/// Immutable; safe to share between threads.
class LiveScene {
 public:
  /// Of a mock lab: its own lenses and parts as the robot believes them to be, arm and ball at rest.
  explicit LiveScene(const sim::MockStereo& mock);
  LiveScene(std::shared_ptr<const sim::LiveLab> lab, const StereoLenses& lenses);
  /// Of real cameras: their calibrations, and rig_scene(). `rig` may be null. Throws what that does; InputError where
  /// the right camera's calibration has no T_left_right.
  LiveScene(const StereoConfig& cameras, const Rig* rig, const std::optional<std::filesystem::path>& scene_file);

  /// Nothing where a camera has no calibration.
  const std::optional<StereoLenses>& lenses() const { return lenses_; }
  /// Null: nothing is known of the scene.
  const std::shared_ptr<const SceneModel>& model() const { return model_; }
  /// Of all nodes of the model; `status` as told. Without a model there are none.
  SceneState state_at(RobotTime time, const JointPositions& joints, StateStatus status) const;
  /// By the lab's drawing: where the left camera stands on its head. Only of a mock lab.
  Pose T_world_left(const JointPositions& joints) const;
  bool is_mock() const { return lab_ != nullptr; }

 private:
  std::optional<StereoLenses> lenses_;
  std::shared_ptr<const SceneModel> model_;
  std::shared_ptr<const sim::LiveLab> lab_;  // of a mock lab, else
  std::shared_ptr<const RobotScene> real_;
};

/// What the robot of this rig knows of its surroundings, without opening a camera. `mock`: as_mock() stands for the
/// rig's cameras, which it has; `physics`, `layout`: of the mock lab, what RobotCameraOptions has. Throws what
/// LiveScene, as_mock() and mock_world() do.
LiveScene live_scene_of(const Rig& rig, bool mock, const std::optional<std::filesystem::path>& scene_file,
                        bool physics = false, unsigned layout = 0);

}  // namespace foresight
