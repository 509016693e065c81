#include "texture_gpu/mesh_topology.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <unordered_map>
#include <utility>

namespace foresight {
namespace {

std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) {
  return (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b);
}

}  // namespace

void link_neighbours(const Mesh& mesh, int first, std::vector<Face>& faces) {
  std::unordered_map<std::uint64_t, std::pair<int, int>> open;  // edge to (triangle, side)
  open.reserve(mesh.triangles.size() * 2);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int side = 0; side < 3; ++side) {
      const auto& tri = mesh.triangles[t];
      const auto key = edge_key(tri[static_cast<std::size_t>(side)], tri[static_cast<std::size_t>((side + 1) % 3)]);
      const int id = first + static_cast<int>(t);
      const auto [it, inserted] = open.try_emplace(key, id, side);
      if (inserted || it->second.first < 0) continue;
      const auto [other, other_side] = it->second;
      faces[static_cast<std::size_t>(id)].neighbours[static_cast<std::size_t>(side)] = other;
      faces[static_cast<std::size_t>(other)].neighbours[static_cast<std::size_t>(other_side)] = id;
      it->second.first = -1;  // a third triangle on one edge stays apart
    }
  }
}

bool is_closed(const Mesh& mesh) {
  std::unordered_map<std::uint64_t, int> directed;
  directed.reserve(3 * mesh.triangles.size());
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i)
      if (++directed[std::uint64_t{t[i]} << 32 | t[(i + 1) % 3]] > 1) return false;
    const auto at = [&](std::size_t i) { return mesh.vertices[t[i]].cast<double>(); };
    volume += at(0).dot(at(1).cross(at(2)));
  }
  for (const auto& [edge, count] : directed)
    if (!directed.contains(edge << 32 | edge >> 32)) return false;
  return volume > 0;
}

}  // namespace foresight
