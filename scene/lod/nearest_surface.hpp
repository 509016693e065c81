// The nearest point on a set of triangles.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace foresight {

/// The nearest point of a triangle.
Eigen::Vector3f nearest_on_triangle(const std::array<Eigen::Vector3f, 3>& corners, const Eigen::Vector3f& p);

/// Triangles in a grid of cells about as large as they are. Immutable.
class NearestSurface {
 public:
  using Corners = std::array<Eigen::Vector3f, 3>;

  /// All corners finite.
  explicit NearestSurface(std::vector<Corners> triangles);
  /// Nothing where there is no triangle.
  std::optional<Eigen::Vector3f> operator()(const Eigen::Vector3f& p) const;

 private:
  struct Best {
    float distance = std::numeric_limits<float>::infinity();  // squared
    Eigen::Vector3f p;
  };
  Eigen::Vector3i cell_of(const Eigen::Vector3f& p) const;
  std::size_t index(const Eigen::Vector3i& cell) const;
  void look(const Eigen::Vector3i& cell, const Eigen::Vector3f& p, Best& best) const;
  void look_at_shell(const Eigen::Vector3i& middle, int radius, const Eigen::Vector3f& p, Best& best) const;

  std::vector<Corners> triangles_;
  Eigen::Vector3f low_ = Eigen::Vector3f::Zero();
  Eigen::Vector3i cells_ = Eigen::Vector3i::Ones();
  float side_ = 1;  // of a cell, m
  std::vector<std::uint32_t> first_, items_;
};

}  // namespace foresight
