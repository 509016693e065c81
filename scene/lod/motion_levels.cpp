#include "scene/lod/motion_levels.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {

MotionLevels::MotionLevels(const NodeBoxes& boxes, const MotionLevelOptions& options)
    : options_(options), boxes_(boxes) {}

SceneState MotionLevels::shown(const SceneState& state, const MotionView& view) {
  if (state.T_world_node.size() != boxes_.box.size() || !view.T_world_camera.matrix().allFinite()) return state;
  if (held_.empty()) held_ = newest_ = state.T_world_node;
  for (std::size_t i = 0; i < held_.size(); ++i) {
    const Pose& now = state.T_world_node[i];
    const bool moved = !(now.matrix() == newest_[i].matrix());
    newest_[i] = now;
    counts_.moved += moved;
    if (now.matrix() == held_[i].matrix() || can_be_held(i, now, view)) continue;
    held_[i] = now;
    counts_.shown += moved;
  }
  SceneState out = state;
  out.T_world_node = held_;
  return out;
}

bool MotionLevels::can_be_held(std::size_t node, const Pose& T_world_node, const MotionView& view) const {
  const Eigen::AlignedBox3d& box = boxes_.box[node];
  if (box.isEmpty()) return false;
  const Pose T_camera_world = view.T_world_camera.inverse();
  double k = 1;
  if (options_.eye_looks_ahead) {
    const Eigen::Vector3d middle = T_camera_world * T_world_node * box.center();
    k = acuity({.eccentricity = std::atan2(middle.head<2>().norm(), middle.z()), .distance = middle.norm()},
               options_.acuity);
  }
  const double allowed = options_.px / (k * view.focal_px);  // rad
  for (int c = 0; c < 8; ++c) {
    const Eigen::Vector3d corner = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(c));
    const Eigen::Vector3d now = T_camera_world * T_world_node * corner, then = T_camera_world * held_[node] * corner;
    if (!((now - then).norm() <= allowed * std::min(now.norm(), then.norm()))) return false;
  }
  return true;
}

}  // namespace foresight
