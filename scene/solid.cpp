#include "scene/solid.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

namespace foresight {
namespace {

bool is_closed(const Mesh& mesh) {
  std::vector<std::uint64_t> there, back;  // edges, from << 32 | to
  there.reserve(3 * mesh.triangles.size());
  back.reserve(3 * mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint64_t from = t[i], to = t[(i + 1) % 3];
      there.push_back(from << 32 | to);
      back.push_back(to << 32 | from);
    }
  std::ranges::sort(there);
  if (std::ranges::adjacent_find(there) != there.end()) return false;
  std::ranges::sort(back);
  return there == back;
}

/// For each vertex, one vertex of the part that it is in, the same for all of that part.
std::vector<std::uint32_t> parts_of(const Mesh& mesh) {
  std::vector<std::uint32_t> part(mesh.vertices.size());
  std::iota(part.begin(), part.end(), 0u);
  const auto root = [&](std::uint32_t v) {
    while (part[v] != v) v = part[v] = part[part[v]];
    return v;
  };
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 1; i < 3; ++i) part[root(t[i])] = root(t[0]);
  for (std::uint32_t& v : part) v = root(v);
  return part;
}

}  // namespace

bool is_solid(const Mesh& mesh) {
  if (mesh.triangles.empty() || !is_closed(mesh)) return false;
  const std::vector<std::uint32_t> part = parts_of(mesh);
  std::vector<double> volume(mesh.vertices.size());
  for (const auto& t : mesh.triangles) {
    const std::uint32_t of = part[t[0]];
    // Beside one of its own vertices, so that small bodies far from the origin keep their digits.
    const auto at = [&](std::size_t i) {
      return (mesh.vertices[t[i]].cast<double>() - mesh.vertices[of].cast<double>()).eval();
    };
    volume[of] += at(0).dot(at(1).cross(at(2)));
  }
  return std::ranges::all_of(mesh.triangles, [&](const auto& t) { return volume[part[t[0]]] > 0; });
}

}  // namespace foresight
