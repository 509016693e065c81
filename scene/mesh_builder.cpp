#include "scene/mesh_builder.hpp"

#include <Eigen/Geometry>
#include <bit>
#include <numeric>

namespace foresight {
namespace {

// Twice the area vector of a polygon (Newell); its direction is the polygon's normal.
Eigen::Vector3d area_vector(std::span<const Eigen::Vector3f> p) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const Eigen::Vector3d origin = p[0].cast<double>();
  for (std::size_t i = 1; i + 1 < p.size(); ++i)
    sum += (p[i].cast<double>() - origin).cross(p[i + 1].cast<double>() - origin);
  return sum;
}

bool has_area(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
  const Eigen::Vector3d ab = b.cast<double>() - a.cast<double>(), ac = c.cast<double>() - a.cast<double>();
  const Eigen::Vector3d bc = ac - ab;
  const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), bc.squaredNorm()});
  // A height under a millionth of the longest side is rounding of the file's numbers.
  return ab.cross(ac).norm() > 1e-6 * longest;
}

// Can corner i be cut off? It must be convex, and no other corner may lie in its triangle.
bool is_ear(std::span<const Eigen::Vector3f> p, const std::vector<std::size_t>& ring, std::size_t i,
            const Eigen::Vector3d& normal) {
  const std::size_t n = ring.size(), ia = ring[(i + n - 1) % n], ib = ring[i], ic = ring[(i + 1) % n];
  const Eigen::Vector3d a = p[ia].cast<double>(), b = p[ib].cast<double>(), c = p[ic].cast<double>();
  const auto side = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::Vector3d& point) {
    return (to - from).cross(point - from).dot(normal);
  };
  if (side(a, b, c) <= 0) return false;
  for (std::size_t k : ring) {
    if (p[k] == p[ia] || p[k] == p[ib] || p[k] == p[ic]) continue;
    const Eigen::Vector3d q = p[k].cast<double>();
    if (side(a, b, q) >= 0 && side(b, c, q) >= 0 && side(c, a, q) >= 0) return false;
  }
  return true;
}

}  // namespace

std::size_t MeshBuilder::Hash::operator()(const Eigen::Vector3f& v) const {
  std::uint64_t h = 0;
  for (float f : {v.x(), v.y(), v.z()}) {
    h = (h ^ std::bit_cast<std::uint32_t>(f)) * 0x9E3779B97F4A7C15u;  // Fibonacci hashing
    h ^= h >> 29;
  }
  return static_cast<std::size_t>(h);
}

std::uint32_t MeshBuilder::weld(const Eigen::Vector3f& v) {
  const Eigen::Vector3f key = v + Eigen::Vector3f::Zero();  // -0 and +0 are one place
  const auto [it, is_new] = index_.try_emplace(key, static_cast<std::uint32_t>(mesh_.vertices.size()));
  if (is_new) mesh_.vertices.push_back(key);
  return it->second;
}

void MeshBuilder::add_triangle(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
  if (has_area(a, b, c))
    mesh_.triangles.push_back({weld(a), weld(b), weld(c)});
  else
    ++mesh_.dropped_degenerate;
}

void MeshBuilder::add(std::span<const Eigen::Vector3f> corners) {
  if (corners.size() < 3) {
    ++mesh_.dropped_degenerate;
    return;
  }
  if (corners.size() == 3) return add_triangle(corners[0], corners[1], corners[2]);
  // Ear clipping, O(n^3) at worst; very large polygons fall back to a fan below.
  constexpr std::size_t kLargest = 256;
  std::vector<std::size_t> ring(corners.size());
  std::iota(ring.begin(), ring.end(), std::size_t{0});
  const Eigen::Vector3d normal = area_vector(corners);
  while (ring.size() > 3 && ring.size() <= kLargest) {
    std::size_t i = 0;
    while (i < ring.size() && !is_ear(corners, ring, i, normal)) ++i;
    if (i == ring.size()) break;  // crosses itself: any cut is as good as another
    const std::size_t n = ring.size();
    add_triangle(corners[ring[(i + n - 1) % n]], corners[ring[i]], corners[ring[(i + 1) % n]]);
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(i));
  }
  for (std::size_t k = 1; k + 1 < ring.size(); ++k)
    add_triangle(corners[ring[0]], corners[ring[k]], corners[ring[k + 1]]);
}

Mesh merged(std::span<const Mesh> parts, std::span<const Eigen::Affine3d> T) {
  MeshBuilder builder;
  std::size_t dropped = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    dropped += parts[i].dropped_degenerate;
    for (const auto& triangle : parts[i].triangles) {
      Eigen::Vector3f corners[3];
      for (std::size_t k = 0; k < 3; ++k)
        corners[k] = (T[i] * parts[i].vertices[triangle[k]].cast<double>()).cast<float>();
      builder.add(corners);
    }
  }
  Mesh mesh = std::move(builder).take();
  mesh.dropped_degenerate += dropped;
  return mesh;
}

}  // namespace foresight
