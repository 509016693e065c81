#include "scene/run_units.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "common/text.hpp"

namespace foresight {
namespace {

constexpr double kLarge = 250;    // m, and of the camera's path
constexpr double kSmallPath = 1;  // m: a camera that moves less tells as much of the scene's size as one that does
constexpr double kLeast = 0.005;  // rad that a part takes: two to five pixels of most cameras

Eigen::AlignedBox3d box_of(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& vertex : mesh.vertices) box.extend(vertex.cast<double>());
  return box;
}

std::vector<Eigen::AlignedBox3d> boxes_of(const SceneModel& scene) {
  std::vector<Eigen::AlignedBox3d> out;
  for (const Node& node : scene.nodes()) out.push_back(box_of(node.mesh));
  return out;
}

std::optional<std::string> too_large(const RunFolder& run, const std::vector<Eigen::AlignedBox3d>& boxes) {
  Eigen::AlignedBox3d path;
  for (const RunFrame& frame : run.frames()) path.extend(frame.left.T_world_camera.translation());
  const double moved = path.diagonal().norm();
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const double size = boxes[i].isEmpty() ? 0 : boxes[i].sizes().maxCoeff();
    if (size > kLarge * std::max(moved, kSmallPath))
      return fmt::format(
          "{} of the model is {:.0f} m large, and the camera's path {:.1f} m: if it is in millimetres, "
          "scale its mesh by 0.001, as models are in metres",
          in_quotes(run.scene()->nodes()[i].name), size, moved);
  }
  return std::nullopt;
}

std::optional<std::string> too_small(const RunFolder& run, const std::vector<Eigen::AlignedBox3d>& boxes) {
  double largest = 0, nearest = 0;
  std::size_t part = 0;
  for (const RunFrame& frame : run.frames()) {
    const SceneState state = run.state_at(frame.left.time);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      if (boxes[i].isEmpty()) continue;
      const Eigen::Vector3d p_node = state.T_world_node[i].inverse() * frame.left.T_world_camera.translation();
      const double away = boxes[i].exteriorDistance(p_node), taken = boxes[i].diagonal().norm() / std::max(away, 1e-9);
      if (taken > kLeast) return std::nullopt;
      if (taken < largest) continue;
      largest = taken;
      nearest = away;
      part = i;
    }
  }
  return fmt::format(
      "no part of the model takes more than some pixels of an image ({} is {:.3g} m large, and {:.4g} m away "
      "at least): models and trajectory.txt are in metres",
      in_quotes(run.scene()->nodes()[part].name), boxes[part].diagonal().norm(), nearest);
}

}  // namespace

std::optional<std::string> doubt_of_units(const RunFolder& run) {
  const std::vector<Eigen::AlignedBox3d> boxes = boxes_of(*run.scene());
  if (auto doubt = too_large(run, boxes)) return doubt;
  return too_small(run, boxes);
}

}  // namespace foresight
