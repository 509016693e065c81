#include "texture_gpu/lamp/witnesses.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

namespace foresight {
namespace {

constexpr std::size_t kTries = 20;  // for each point that is wanted
constexpr double kReach = 1.5;      // times the extent of what moves: so far its shadows matter fully

Eigen::AlignedBox3f box_of(const SceneModel& scene, const std::vector<Pose>& T_world_node,
                           const std::vector<bool>& moving) {
  Eigen::AlignedBox3f box;
  for (std::size_t i = 0; i < scene.nodes().size(); ++i) {
    if (!moving[i]) continue;
    const Eigen::Isometry3f T = T_world_node[i].cast<float>();
    for (const Eigen::Vector3f& v : scene.nodes()[i].mesh.vertices) box.extend(T * v);
  }
  return box;
}

}  // namespace

std::vector<Witness> choose_witnesses(const SceneModel& scene, const std::vector<Pose>& T_world_node,
                                      const std::vector<bool>& moving, std::size_t count) {
  struct Triangle {
    int node;
    Eigen::Vector3f a, ab, ac;
  };
  std::vector<Triangle> triangles;
  std::vector<double> areas;
  for (std::size_t i = 0; i < scene.nodes().size(); ++i) {
    if (moving[i]) continue;
    const Eigen::Isometry3f T = T_world_node[i].cast<float>();
    const Mesh& mesh = scene.nodes()[i].mesh;
    for (const auto& t : mesh.triangles) {
      const Eigen::Vector3f a = T * mesh.vertices[t[0]], b = T * mesh.vertices[t[1]], c = T * mesh.vertices[t[2]];
      triangles.push_back({static_cast<int>(i), a, b - a, c - a});
      areas.push_back((b - a).cross(c - a).norm());
    }
  }
  std::vector<Witness> out;
  const Eigen::AlignedBox3f box = box_of(scene, T_world_node, moving);
  if (triangles.empty() || box.isEmpty()) return out;
  const double reach = kReach * std::max(0.1f, box.diagonal().norm());
  std::mt19937 generator(1);
  std::discrete_distribution<std::size_t> any(areas.begin(), areas.end());
  std::uniform_real_distribution<float> even(0, 1);
  for (std::size_t i = 0; i < kTries * count && out.size() < count; ++i) {
    const Triangle& t = triangles[any(generator)];
    float u = even(generator), v = even(generator);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Eigen::Vector3f p = t.a + u * t.ab + v * t.ac;
    const double far = box.exteriorDistance(p) / reach;
    if (even(generator) < std::exp(-2 * far)) out.push_back({t.node, p, t.ab.cross(t.ac).normalized()});
  }
  return out;
}

}  // namespace foresight
