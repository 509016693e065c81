#include "texture_gpu/mesh_topology.hpp"

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

}  // namespace foresight
