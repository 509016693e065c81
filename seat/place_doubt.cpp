#include "seat/place_doubt.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

constexpr double kSeenOfSigma = 0.5;  // sigma covers 95 % of all states, those while a joint is being learnt too
constexpr double kNearest = 0.05;     // m: what is closer is as far off as this

/// Where the middles are seen, in px; what is behind the camera as if it were before it.
std::vector<Eigen::Vector2d> seen_at(const ViewPlace& place, const Lens& lens,
                                     std::span<const Eigen::Vector3d> middles) {
  const Pose T_camera_world = place.T_world_camera.inverse();
  const double f = std::max(lens.parameters().fx, lens.parameters().fy);
  std::vector<Eigen::Vector2d> out;
  for (std::size_t i = 0; i < middles.size(); ++i) {
    const Eigen::Vector3d p = T_camera_world * place.scene.T_world_node[i] * middles[i];
    out.emplace_back(f * p.head<2>() / std::max(std::abs(p.z()), kNearest));
  }
  return out;
}

}  // namespace

std::vector<Eigen::Vector3d> node_middles(const SceneModel& scene) {
  std::vector<Eigen::Vector3d> out;
  for (const Node& node : scene.nodes()) {
    Eigen::AlignedBox3d box;
    for (const auto& p : node.mesh.vertices) box.extend(p.cast<double>());
    out.push_back(box.isEmpty() ? Eigen::Vector3d(0, 0, 0) : Eigen::Vector3d(box.center()));
  }
  return out;
}

std::vector<double> node_doubt_px(const PredictedPlaces& places, const PredictedRobot& robot, const Lens& lens,
                                  std::span<const Eigen::Vector3d> middles, const std::optional<ViewPlace>& before) {
  if (robot.status == StateStatus::invalid) return std::vector<double>(middles.size(), kAnywherePx);
  const auto here = seen_at(places.place(robot), lens, middles);
  std::vector<double> squares(middles.size(), 0);
  const auto add = [&](const ViewPlace& other, double share) {
    const auto there = seen_at(other, lens, middles);
    for (std::size_t i = 0; i < middles.size(); ++i) squares[i] += share * share * (there[i] - here[i]).squaredNorm();
  };
  for (std::size_t joint = 0; joint < robot.joints; ++joint) {
    const double sigma = robot.sigma[joint];
    if (!(sigma > 0) || !std::isfinite(sigma)) continue;
    PredictedRobot other = robot;
    other.position[joint] += sigma;
    add(places.place(other), kSeenOfSigma);
  }
  for (double& px : squares)
    if (px > kNotKnownPx * kNotKnownPx) px = kAnywherePx * kAnywherePx;
  const double passed = before ? to_seconds(robot.time - before->scene.time) : 0;
  if (passed > 0 && before->scene.T_world_node.size() == middles.size()) add(*before, kBlurred / passed);
  for (double& px : squares) px = std::isfinite(px) ? std::min(std::sqrt(px), kAnywherePx) : kAnywherePx;
  return squares;
}

}  // namespace foresight
