#include "texture_gpu/chart_resolution.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace foresight {
namespace {

constexpr double kNearest = 0.05;   // metres; views from nearer do not ask for more texels
constexpr double kFlattest = 0.25;  // of the head-on density: a grazing view may come closer head-on soon

bool in_frustum(const Eigen::Vector3d& p, double r, const AtlasView& view) {
  const auto& f = *view.faces;
  if (f.count > 1) {
    const double angle = std::atan2(p.head<2>().norm(), p.z());
    return p.norm() <= r || angle - std::asin(r / p.norm()) <= view.lens->max_angle();
  }
  if (p.z() + r <= gl::kNearPlane) return false;
  // Signed distances from the four planes through the camera and the borders of the face.
  const auto outside = [&](double x, double focal_px, double border) {
    return (focal_px * x + border * p.z()) / std::hypot(focal_px, border) < -r;
  };
  return !outside(p.x(), f.fx, f.cx + 0.5) && !outside(-p.x(), f.fx, f.width - 0.5 - f.cx) &&
         !outside(p.y(), f.fy, f.cy + 0.5) && !outside(-p.y(), f.fy, f.height - 0.5 - f.cy);
}

/// True where every triangle of a solid's chart is turned away from a camera outside it, wherever it lies in
/// the chart's sphere. `n_node`: the patch's normal.
bool shows_its_back(const Chart& chart, const Eigen::Vector3d& n_node, const Pose& T_camera_node) {
  const Eigen::Vector3d p = T_camera_node * chart.center, n = T_camera_node.linear() * n_node;
  if (p.norm() <= chart.radius || chart.may_show_back(T_camera_node.inverse().translation())) return false;
  if (chart.cone < 1e-3) return n.dot(p) > 1e-9;  // all in one plane: the camera is behind it
  const double angle = chart.cone + std::asin(chart.radius / p.norm());
  return angle < std::numbers::pi / 2 && n.dot(p) / p.norm() > std::sin(angle);
}

}  // namespace

Eigen::Vector2d density_in_view(const Chart& chart, const Patch& patch, const AtlasView& view) {
  const Pose& T_camera_node = view.T_camera_node[static_cast<std::size_t>(patch.node)];
  const Eigen::Vector3d p = T_camera_node * chart.center;
  if (!in_frustum(p, chart.radius, view) || shows_its_back(chart, patch.n, T_camera_node))
    return Eigen::Vector2d::Zero();
  const auto& lens = view.lens->parameters();
  const double focal = std::max(lens.fx, lens.fy);
  // Angular resolution at the chart's centre. A chart around the camera counts as half a radius away.
  const double distance = std::max({p.norm(), 0.5 * chart.radius, kNearest});
  const Eigen::Vector3d sight = p.normalized();
  const double depth = view.faces->count > 1 ? distance : std::max({p.z(), 0.5 * chart.radius, kNearest});
  const double scale = focal / depth;
  // A step along u on a slope also rises: the steepest usual slope shows it longest.
  const auto pixels_per_metre = [&](const Eigen::Vector3d& axis) {
    double most = kFlattest;
    for (double s : {-chart.slope, 0.0, chart.slope}) {
      const Eigen::Vector3d step = T_camera_node.linear() * (axis + s * patch.n);
      most = std::max(most, (step - sight * sight.dot(step)).norm());
    }
    return most * scale;
  };
  return {pixels_per_metre(patch.eu), pixels_per_metre(patch.ev)};
}

}  // namespace foresight
