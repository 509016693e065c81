#include "texture_gpu/polygons.hpp"

#include <algorithm>
#include <map>
#include <optional>

namespace foresight {
namespace {

constexpr double kFlat = 1e-5;     // sine of the largest angle between joined triangles
constexpr double kConvex = -1e-6;  // least sine of an inner turn: straight on is convex

using Edge = std::pair<std::uint32_t, std::uint32_t>;
using Loop = std::vector<std::uint32_t>;  // vertex indices, counter-clockwise

/// The outline of two loops together, or nothing where it is not a single loop.
std::optional<Loop> join(const Loop& a, const Loop& b) {
  std::map<std::uint32_t, std::uint32_t> next;  // borders of both, without what they share
  std::map<Edge, int> edges;
  for (const Loop* loop : {&a, &b})
    for (std::size_t i = 0; i < loop->size(); ++i) ++edges[{(*loop)[i], (*loop)[(i + 1) % loop->size()]}];
  for (const auto& [edge, count] : edges) {
    if (count > 1) return std::nullopt;
    if (!edges.contains({edge.second, edge.first}) && !next.emplace(edge.first, edge.second).second)
      return std::nullopt;
  }
  if (next.size() < 3) return std::nullopt;
  Loop out;
  const std::uint32_t start = next.begin()->first;
  for (std::uint32_t v = start; out.size() < next.size();) {
    out.push_back(v);
    const auto at = next.find(v);
    if (at == next.end()) return std::nullopt;
    v = at->second;
    if (v == start) break;
  }
  return out.size() == next.size() ? std::optional(out) : std::nullopt;
}

class NodePolygons {
 public:
  explicit NodePolygons(const Mesh& mesh) : mesh_(mesh) {
    std::map<Edge, std::size_t> owner;
    std::vector<std::pair<std::size_t, std::size_t>> neighbours;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& corners = mesh.triangles[t];
      loops_.push_back({corners.begin(), corners.end()});
      members_.push_back({t});
      normals_.push_back(normal_of(corners));
      group_.push_back(t);
    }
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        const Edge edge{mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]};
        if (const auto twin = owner.find({edge.second, edge.first}); twin != owner.end())
          neighbours.emplace_back(t, twin->second);
        owner.emplace(edge, t);
      }
    // Again and again: two rows of a grid fit together only once both are whole.
    const auto joins = [this](const auto& pair) { return try_join(pair.first, pair.second); };
    while (std::count_if(neighbours.begin(), neighbours.end(), joins) > 0) {
    }
  }

  template <typename Use>
  void for_each(Use&& use) const {
    for (std::size_t g = 0; g < loops_.size(); ++g)
      if (!members_[g].empty()) use(loops_[g], members_[g], normals_[g]);
  }

 private:
  Eigen::Vector3d at(std::uint32_t v) const { return mesh_.vertices[v].cast<double>(); }

  Eigen::Vector3d normal_of(const std::array<std::uint32_t, 3>& t) const {
    return (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).normalized();
  }

  bool convex(const Loop& loop, const Eigen::Vector3d& normal) const {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Eigen::Vector3d a = at(loop[i]), b = at(loop[(i + 1) % loop.size()]), c = at(loop[(i + 2) % loop.size()]);
      if ((b - a).normalized().cross((c - b).normalized()).dot(normal) < kConvex) return false;
    }
    return true;
  }

  bool try_join(std::size_t t, std::size_t u) {
    const std::size_t a = group_[t], b = group_[u];
    if (a == b || normals_[a].cross(normals_[b]).norm() > kFlat || normals_[a].dot(normals_[b]) < 0) return false;
    const auto joined = join(loops_[a], loops_[b]);
    if (!joined || !convex(*joined, normals_[a])) return false;
    loops_[a] = *joined;
    for (std::size_t member : members_[b]) group_[member] = a;
    members_[a].insert(members_[a].end(), members_[b].begin(), members_[b].end());
    members_[b].clear();
    return true;
  }

  const Mesh& mesh_;
  std::vector<Loop> loops_;
  std::vector<std::vector<std::size_t>> members_;  // triangles; empty: went into another polygon
  std::vector<Eigen::Vector3d> normals_;
  std::vector<std::size_t> group_;  // polygon of each triangle
};

}  // namespace

std::vector<Polygon> find_polygons(const SceneModel& scene) {
  std::vector<Polygon> polygons;
  std::uint32_t first_triangle = 0;
  for (std::size_t node = 0; node < scene.nodes().size(); ++node) {
    const Mesh& mesh = scene.nodes()[node].mesh;
    NodePolygons(mesh).for_each([&](const Loop& loop, const auto& members, const Eigen::Vector3d& normal) {
      Polygon polygon;
      polygon.node = static_cast<int>(node);
      polygon.normal = normal;
      for (std::uint32_t v : loop) polygon.corners.push_back(mesh.vertices[v].cast<double>());
      for (std::size_t t : members) {
        polygon.triangles.push_back(mesh.triangles[t]);
        polygon.scene_triangles.push_back(first_triangle + static_cast<std::uint32_t>(t));
      }
      polygons.push_back(std::move(polygon));
    });
    first_triangle += static_cast<std::uint32_t>(mesh.triangles.size());
  }
  return polygons;
}

}  // namespace foresight
