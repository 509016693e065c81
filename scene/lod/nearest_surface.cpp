#include "scene/lod/nearest_surface.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

constexpr float kTrianglesInCell = 2;
constexpr int kMostCells = 512;  // along an axis

Eigen::Vector3f nearest_on_segment(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& p) {
  const Eigen::Vector3f along = b - a;
  const float length = along.squaredNorm();
  if (length == 0) return a;
  return a + std::clamp(along.dot(p - a) / length, 0.0f, 1.0f) * along;
}

}  // namespace

Eigen::Vector3f nearest_on_triangle(const std::array<Eigen::Vector3f, 3>& corners, const Eigen::Vector3f& p) {
  const Eigen::Vector3f normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  Eigen::Vector3f best = corners[0];
  float distance = std::numeric_limits<float>::infinity();
  bool inside = normal.squaredNorm() > 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3f &a = corners[k], &b = corners[(k + 1) % 3];
    inside = inside && normal.dot((b - a).cross(p - a)) >= 0;
    const Eigen::Vector3f q = nearest_on_segment(a, b, p);
    if ((q - p).squaredNorm() >= distance) continue;
    distance = (q - p).squaredNorm();
    best = q;
  }
  if (!inside) return best;
  return p - normal * (normal.dot(p - corners[0]) / normal.squaredNorm());
}

NearestSurface::NearestSurface(std::vector<Corners> triangles) : triangles_(std::move(triangles)) {
  Eigen::AlignedBox3f all;
  double extent = 0;
  for (const Corners& t : triangles_) {
    Eigen::AlignedBox3f box;
    for (const Eigen::Vector3f& corner : t) box.extend(corner);
    extent += static_cast<double>(box.sizes().maxCoeff()) / static_cast<double>(triangles_.size());
    all.extend(box);
  }
  if (triangles_.empty()) {
    first_.assign(2, 0);
    return;
  }
  low_ = all.min();
  side_ = std::max({static_cast<float>(extent) * kTrianglesInCell / 2, all.sizes().maxCoeff() / kMostCells, 1e-9f});
  cells_ = cell_of(all.max()) + Eigen::Vector3i::Ones();

  // Twice through the cells of each triangle's box: to count, and to put it there.
  first_.assign(static_cast<std::size_t>(cells_.prod()) + 1, 0);
  const auto visit = [&](auto&& take) {
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
      Eigen::AlignedBox3f box;
      for (const Eigen::Vector3f& corner : triangles_[i]) box.extend(corner);
      const Eigen::Vector3i from = cell_of(box.min()), to = cell_of(box.max());
      for (int z = from.z(); z <= to.z(); ++z)
        for (int y = from.y(); y <= to.y(); ++y)
          for (int x = from.x(); x <= to.x(); ++x) take(index({x, y, z}), i);
    }
  };
  visit([&](std::size_t cell, std::uint32_t) { ++first_[cell + 1]; });
  for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  items_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  visit([&](std::size_t cell, std::uint32_t i) { items_[next[cell]++] = i; });
}

Eigen::Vector3i NearestSurface::cell_of(const Eigen::Vector3f& p) const {
  return ((p - low_) / side_).array().floor().cast<int>();
}

std::size_t NearestSurface::index(const Eigen::Vector3i& cell) const {
  return (static_cast<std::size_t>(cell.z()) * static_cast<std::size_t>(cells_.y()) +
          static_cast<std::size_t>(cell.y())) *
             static_cast<std::size_t>(cells_.x()) +
         static_cast<std::size_t>(cell.x());
}

void NearestSurface::look(const Eigen::Vector3i& cell, const Eigen::Vector3f& p, Best& best) const {
  const std::size_t at = index(cell);
  for (std::size_t i = first_[at]; i < first_[at + 1]; ++i) {
    const Eigen::Vector3f q = nearest_on_triangle(triangles_[items_[i]], p);
    if ((q - p).squaredNorm() < best.distance) best = {(q - p).squaredNorm(), q};
  }
}

void NearestSurface::look_at_shell(const Eigen::Vector3i& middle, int radius, const Eigen::Vector3f& p,
                                   Best& best) const {
  const Eigen::Vector3i from = (middle.array() - radius).max(0), to = (middle.array() + radius).min(cells_.array() - 1);
  for (int z = from.z(); z <= to.z(); ++z)
    for (int y = from.y(); y <= to.y(); ++y) {
      const bool whole_row = std::abs(z - middle.z()) == radius || std::abs(y - middle.y()) == radius;
      for (int x = from.x(); x <= to.x(); ++x)
        if (whole_row || std::abs(x - middle.x()) == radius) look({x, y, z}, p, best);
    }
}

std::optional<Eigen::Vector3f> NearestSurface::operator()(const Eigen::Vector3f& p) const {
  if (triangles_.empty()) return std::nullopt;
  const Eigen::Vector3i middle = cell_of(p).cwiseMax(0).cwiseMin(cells_ - Eigen::Vector3i::Ones());
  Best best;
  for (int radius = 0; radius < cells_.maxCoeff(); ++radius) {
    look_at_shell(middle, radius, p, best);
    // What has not been looked at is farther than that, were the point in the middle cell; it is, or outside of all.
    const float seen = static_cast<float>(radius) * side_;
    if (best.distance <= seen * seen) break;
  }
  if (std::isinf(best.distance)) return std::nullopt;
  return best.p;
}

}  // namespace foresight
