// Boxes around the triangles of a part, halved again and again, to find the nearest triangles of two parts.
//
// Boxes lie along the axes of their part, as the faces of machines mostly do. Two boxes are at least as far apart as
// their extents along the axes of the one part, and of the other: twenty operations each, where FCL's rounded
// rectangles take ten times as long and prune little more.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "scene/scene_model.hpp"

namespace foresight {

using Corners = std::array<Eigen::Vector3d, 3>;

/// Immutable; any thread. Neither nearest() nor a constructed tree allocates.
class TriangleTree {
 public:
  TriangleTree() = default;
  explicit TriangleTree(std::vector<Corners> triangles);
  explicit TriangleTree(const Mesh& mesh);

  std::size_t size() const noexcept { return triangles_.size(); }
  const Corners& triangle(std::size_t index) const noexcept { return triangles_[index]; }

  /// Of two triangles, the nearest points in the first part's frame, and how far they are apart, m.
  struct Nearest {
    double distance = 0;
    Eigen::Vector3d point{0, 0, 0}, other_point{0, 0, 0};
    std::array<int, 2> triangles{-1, -1};  ///< -1: none are nearer than what was to be beaten
  };
  /// `T`: from the other part's frame to this one's. Looks for triangles nearer than `beat` metres; of several that are
  /// equally near, finds the first in an order that does not depend on `beat`.
  Nearest nearest(const TriangleTree& other, const Pose& T, double beat) const noexcept;
  /// No two triangles are nearer than this, m; 0 where the boxes around all of them overlap. Both have triangles.
  double at_least(const TriangleTree& other, const Pose& T) const noexcept;
  /// The nearest points of two triangles, one of each part.
  Nearest between(const TriangleTree& other, const Pose& T, std::array<int, 2> triangles) const noexcept;

 private:
  struct Box {
    Eigen::Vector3d center, half;
    int triangle = -1;  ///< of a leaf; else the first half is the next box, and:
    int second = -1;
    double size = 0;  ///< half the diagonal
  };
  struct Search;

  int build(std::vector<int>& order, std::size_t from, std::size_t to);

  std::vector<Corners> triangles_;
  std::vector<Box> boxes_;
};

}  // namespace foresight
