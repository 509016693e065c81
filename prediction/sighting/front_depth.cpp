#include "prediction/sighting/front_depth.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

namespace foresight {
namespace {

// Of a straight edge's bend by the lens, in coarse pixels for each that it is long.
constexpr double kBend = 0.1;

}  // namespace

CoarseRays::CoarseRays(const Lens& lens)
    : lens_(lens),
      width_(static_cast<std::size_t>((lens.width() + kShrink - 1) / kShrink)),
      height_(static_cast<std::size_t>((lens.height() + kShrink - 1) / kShrink)) {
  rays_.reserve(width_ * height_);
  constexpr double kMiddle = (kShrink - 1) / 2.0;
  for (std::size_t row = 0; row < height_; ++row)
    for (std::size_t column = 0; column < width_; ++column)
      rays_.push_back(lens.unproject({kShrink * static_cast<double>(column) + kMiddle,
                                      kShrink * static_cast<double>(row) + kMiddle})
                          .value_or(Eigen::Vector3d::Zero()));
}

FrontDepth::FrontDepth(const CoarseRays& rays, const SceneModel& model, const SceneState& scene,
                       const Pose& T_world_camera)
    : rays_(rays), nearest_(rays.width() * rays.height()) {
  if (scene.T_world_node.size() != model.nodes().size())
    throw std::invalid_argument("FrontDepth: a pose for each node is needed");
  const Pose T_camera_world = T_world_camera.inverse();
  for (std::size_t i = 0; i < model.nodes().size(); ++i)
    draw(model.nodes()[i].mesh, T_camera_world * scene.T_world_node[i], static_cast<int>(i));
}

void FrontDepth::draw(const Mesh& mesh, const Pose& T_camera_node, int node) {
  std::vector<Eigen::Vector3d> p;
  std::vector<std::optional<Eigen::Vector2d>> pixel;
  p.reserve(mesh.vertices.size());
  pixel.reserve(mesh.vertices.size());
  for (const Eigen::Vector3f& v : mesh.vertices) {
    p.push_back(T_camera_node * v.cast<double>());
    pixel.push_back(rays_.lens().project(p.back()));
  }
  const Eigen::Array2i end(static_cast<int>(rays_.width()) - 1, static_cast<int>(rays_.height()) - 1);
  for (const auto& t : mesh.triangles) {
    Eigen::Array2i least(0, 0), most = end;  // of a triangle that the lens sees only a part of: everywhere
    if (pixel[t[0]] && pixel[t[1]] && pixel[t[2]]) {
      const Eigen::Array2d low = pixel[t[0]]->array().min(pixel[t[1]]->array()).min(pixel[t[2]]->array());
      const Eigen::Array2d high = pixel[t[0]]->array().max(pixel[t[1]]->array()).max(pixel[t[2]]->array());
      const double more = 1 + kBend * (high - low).maxCoeff() / CoarseRays::kShrink;
      least = ((low / CoarseRays::kShrink - more).max(-1e6).min(1e6)).floor().cast<int>().max(least);
      most = ((high / CoarseRays::kShrink + more).max(-1e6).min(1e6)).ceil().cast<int>().min(most);
    } else if (p[t[0]].z() <= 0 && p[t[1]].z() <= 0 && p[t[2]].z() <= 0) {
      continue;
    }
    const Eigen::Vector3d corner[3] = {p[t[0]], p[t[1]], p[t[2]]};
    draw(corner, least, most, node);
  }
}

void FrontDepth::draw(const Eigen::Vector3d corner[3], const Eigen::Array2i& least, const Eigen::Array2i& most,
                      int node) {
  const Eigen::Vector3d a = corner[1] - corner[0], b = corner[2] - corner[0];
  const Eigen::Vector3d from = -corner[0], q = from.cross(a);  // Moeller and Trumbore 1997, from the camera's centre
  const double height = b.dot(q);
  for (int row = least.y(); row <= most.y(); ++row)
    for (int column = least.x(); column <= most.x(); ++column) {
      const auto x = static_cast<std::size_t>(column), y = static_cast<std::size_t>(row);
      const Eigen::Vector3d& d = rays_.ray(x, y);
      const Eigen::Vector3d n = d.cross(b);
      const double det = a.dot(n);
      if (std::abs(det) < 1e-14) continue;
      const double u = from.dot(n) / det, v = d.dot(q) / det;
      if (u < 0 || v < 0 || u + v > 1) continue;
      const auto range = static_cast<float>(height / det);
      Nearest& there = nearest_[y * rays_.width() + x];
      if (range > 0 && (there.node < 0 || range < there.range)) there = {range, node};
    }
}

bool FrontDepth::hidden(const Eigen::Vector2d& pixel, double range, std::size_t node) const {
  const double x = std::round((pixel.x() - 1.5) / CoarseRays::kShrink),
               y = std::round((pixel.y() - 1.5) / CoarseRays::kShrink);
  if (!(x >= 0 && y >= 0 && x < static_cast<double>(rays_.width()) && y < static_cast<double>(rays_.height())))
    return false;
  const Nearest& there = nearest_[static_cast<std::size_t>(y) * rays_.width() + static_cast<std::size_t>(x)];
  return there.node >= 0 && there.node != static_cast<int>(node) && there.range < range - kMargin;
}

}  // namespace foresight
