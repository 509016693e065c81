#include "scene/visibility.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

constexpr double kMargin = 1e-4;       // m: rasterisers round
constexpr double kClose = 0.05;        // m from a portal's plane
constexpr int kMostPyramids = 20'000;  // beyond, portals cost more than they save
constexpr double kAtRest = 1e-9;

/// The part of a convex polygon on the side of the plane through `eye` to which `inward` points.
std::vector<Eigen::Vector3d> clipped(const std::vector<Eigen::Vector3d>& polygon, const Eigen::Vector3d& eye,
                                     const Eigen::Vector3d& inward) {
  std::vector<Eigen::Vector3d> out;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector3d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double at = inward.dot(a - eye) + kMargin, bt = inward.dot(b - eye) + kMargin;
    if (at >= 0) out.push_back(a);
    if ((at >= 0) != (bt >= 0)) out.push_back(a + at / (at - bt) * (b - a));
  }
  return out;
}

/// Follows portals from cell to cell.
class Walk {
 public:
  Walk(const NodeBoxes& nodes, const SceneState& state, const CellGraph& cells, std::vector<bool>& seen)
      : nodes_(nodes), state_(state), cells_(cells), seen_(seen), on_path_(cells.cells().size()) {}

  /// False: there were too many ways.
  bool enter(int cell, const ViewPyramid& pyramid) {
    if (++pyramids_ > kMostPyramids) return false;
    for (const int node : cells_.cells()[static_cast<std::size_t>(cell)].nodes) {
      const auto n = static_cast<std::size_t>(node);
      if (!seen_[n] && !nodes_.box[n].isEmpty() && !pyramid.misses(nodes_.box[n], state_.T_world_node[n]))
        seen_[n] = true;
    }
    on_path_[static_cast<std::size_t>(cell)] = true;
    bool all = true;
    for (const int index : cells_.portals_of(cell)) {
      const Portal& portal = cells_.portals()[static_cast<std::size_t>(index)];
      const int other = portal.cells[portal.cells[0] == cell ? 1 : 0];
      if (on_path_[static_cast<std::size_t>(other)]) continue;
      if (const auto next = pyramid.through(portal.corners)) all = all && enter(other, *next);
    }
    on_path_[static_cast<std::size_t>(cell)] = false;
    return all;
  }

 private:
  const NodeBoxes& nodes_;
  const SceneState& state_;
  const CellGraph& cells_;
  std::vector<bool>& seen_;
  std::vector<bool> on_path_;
  int pyramids_ = 0;
};

}  // namespace

ViewPyramid::ViewPyramid(const Pose& T_world_pinhole, double left, double right, double top, double bottom)
    : eye_(T_world_pinhole.translation()), ahead_(T_world_pinhole.linear().col(2)) {
  const auto add = [&](double x, double y, double z) {
    inward_.push_back(T_world_pinhole.linear() * Eigen::Vector3d(x, y, z).normalized());
  };
  add(0, 0, 1);
  add(1, 0, -left);
  add(-1, 0, right);
  add(0, 1, -top);
  add(0, -1, bottom);
}

bool ViewPyramid::misses(const Eigen::AlignedBox3d& box, const Pose& T_world_node) const {
  const Eigen::Vector3d middle = T_world_node * box.center() - eye_, half = 0.5 * box.sizes();
  return std::ranges::any_of(inward_, [&](const Eigen::Vector3d& inward) {
    // The corner that is farthest inside.
    const double reach = (T_world_node.linear().transpose() * inward).cwiseAbs().dot(half);
    return inward.dot(middle) + reach < -kMargin;
  });
}

std::optional<ViewPyramid> ViewPyramid::through(const std::vector<Eigen::Vector3d>& polygon) const {
  std::vector<Eigen::Vector3d> left = polygon;
  for (const Eigen::Vector3d& inward : inward_) {
    left = clipped(left, eye_, inward);
    if (left.size() < 3) break;
  }
  Eigen::Vector3d area = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < polygon.size(); ++i)
    area += (polygon[i] - eye_).cross(polygon[(i + 1) % polygon.size()] - eye_);
  const bool close = std::abs(area.normalized().dot(polygon[0] - eye_)) < kClose;
  if (close) return *this;
  if (left.size() < 3) return std::nullopt;
  ViewPyramid out = *this;
  out.inward_.resize(1);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& corner : left) middle += (corner - eye_) / static_cast<double>(left.size());
  for (std::size_t i = 0; i < left.size(); ++i) {
    const Eigen::Vector3d normal = (left[i] - eye_).cross(left[(i + 1) % left.size()] - eye_);
    if (normal.norm() < 1e-9) continue;
    out.inward_.push_back(normal.dot(middle) < 0 ? -normal.normalized() : normal.normalized());
  }
  return out;
}

NodeBoxes::NodeBoxes(const SceneModel& scene) : T_world_rest(scene.rest_poses()) {
  for (const Node& node : scene.nodes()) {
    box.emplace_back();
    for (const Eigen::Vector3f& v : node.mesh.vertices) box.back().extend(v.cast<double>());
  }
}

std::vector<bool> visible_nodes(const ViewPyramid& pyramid, const NodeBoxes& nodes, const SceneState& state,
                                const CellGraph* cells) {
  const std::size_t count = nodes.box.size();
  std::vector<bool> in_pyramid(count), hidden(count, false);
  for (std::size_t i = 0; i < count; ++i)
    in_pyramid[i] = !nodes.box[i].isEmpty() && !pyramid.misses(nodes.box[i], state.T_world_node[i]);
  const std::vector<int> from = cells ? cells->cells_at(pyramid.eye()) : std::vector<int>{};
  if (from.empty()) return in_pyramid;
  std::vector<bool> seen(count, false);
  Walk walk(nodes, state, *cells, seen);
  for (const int cell : from)
    if (!walk.enter(cell, pyramid)) return in_pyramid;
  for (const Cell& cell : cells->cells())
    for (const int node : cell.nodes) {
      const auto n = static_cast<std::size_t>(node);
      hidden[n] = !seen[n] && state.T_world_node[n].isApprox(nodes.T_world_rest[n], kAtRest);
    }
  for (std::size_t i = 0; i < count; ++i) in_pyramid[i] = in_pyramid[i] && !hidden[i];
  return in_pyramid;
}

}  // namespace foresight
