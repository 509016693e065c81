#include "seat/predicted_place.hpp"

#include <algorithm>

#include "calibration/registration/calibrated_head.hpp"
#include "rig/rig_scene.hpp"

namespace foresight {
namespace {

HeadPose calibrated_head(const Rig& rig) {
  std::vector<std::string> names;
  for (const RigJoint& joint : rig.joints)
    if (joint.group == JointGroup::pan_tilt) names.push_back(joint.drive.name);
  const HeadModel model = read_head_model(rig.calibration->pan_tilt.value(), rig.calibration->time);
  return [model, names](const JointPositions& joints) -> std::optional<Pose> {
    const auto pan = joints(names.at(0)), tilt = joints(names.at(1));
    if (!pan || !tilt) return std::nullopt;
    return T_world_camera(
        model, {model.pan.scale * *pan + model.pan.offset_rad, model.tilt.scale * *tilt + model.tilt.offset_rad});
  };
}

}  // namespace

HeadPose head_pose_of(const Rig& rig, const LiveScene& scene) {
  if (rig.calibration && rig.calibration->pan_tilt) return calibrated_head(rig);
  if (!scene.is_mock()) return nullptr;
  return [&rig, &scene](const JointPositions& joints) -> std::optional<Pose> {
    return scene.T_world_left([&](std::string_view name) { return joints(shaft_name(rig, name)); });
  };
}

JointPositions positions_of(const Rig& rig, const JointValues& positions) {
  return [&rig, positions](std::string_view name) -> std::optional<double> {
    for (std::size_t i = 0; i < rig.joints.size(); ++i)
      if (rig.joints[i].drive.name == name && std::isfinite(positions[i])) return positions[i];
    return std::nullopt;
  };
}

PredictedPlaces::PredictedPlaces(const Rig& rig, std::shared_ptr<const LiveScene> scene)
    : rig_(rig), scene_(std::move(scene)), head_(head_pose_of(rig, *scene_)) {}

void PredictedPlaces::saw(const PosedImage& frame, const JointPositions& joints) {
  seen_ = frame.T_world_camera;
  if (!head_) return;
  if (const auto by_head = head_(joints)) T_head_seen_ = by_head->inverse() * *seen_;
}

ViewPlace PredictedPlaces::place(const PredictedRobot& robot) const {
  const JointPositions joints = positions_of(rig_, robot.position);
  ViewPlace out;
  const auto by_head = head_ ? head_(joints) : std::nullopt;
  if (by_head)
    out.T_world_camera = *by_head * T_head_seen_;
  else if (seen_)
    out.T_world_camera = *seen_;
  out.scene = scene_->state_at(
      robot.time, [&](std::string_view name) { return joints(shaft_name(rig_, name)); }, robot.status);
  return out;
}

}  // namespace foresight
