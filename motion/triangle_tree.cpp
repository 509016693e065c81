#include "motion/triangle_tree.hpp"

#include <fcl/narrowphase/detail/primitive_shape_algorithm/triangle_distance.h>

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

Eigen::Vector3d middle(const Corners& t) {
  return (t[0] + t[1] + t[2]) / 3;
}

std::vector<Corners> corners_of(const Mesh& mesh) {
  std::vector<Corners> out;
  const auto at = [&](std::uint32_t i) { return Eigen::Vector3d(mesh.vertices[i].cast<double>()); };
  for (const auto& t : mesh.triangles) out.push_back({at(t[0]), at(t[1]), at(t[2])});
  return out;
}

}  // namespace

TriangleTree::TriangleTree(const Mesh& mesh) : TriangleTree(corners_of(mesh)) {}

TriangleTree::TriangleTree(std::vector<Corners> triangles) : triangles_(std::move(triangles)) {
  std::vector<int> order(triangles_.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  boxes_.reserve(2 * triangles_.size());
  if (!triangles_.empty()) build(order, 0, order.size());
}

int TriangleTree::build(std::vector<int>& order, std::size_t from, std::size_t to) {
  const auto at = [&](std::size_t i) -> const Corners& { return triangles_[static_cast<std::size_t>(order[i])]; };
  const std::size_t index = boxes_.size();
  Eigen::AlignedBox3d around, middles;
  for (std::size_t i = from; i < to; ++i) {
    for (const Eigen::Vector3d& corner : at(i)) around.extend(corner);
    middles.extend(middle(at(i)));
  }
  boxes_.push_back({around.center(), 0.5 * around.sizes(), -1, -1, 0.5 * around.diagonal().norm()});
  if (to - from == 1) {
    boxes_[index].triangle = order[from];
    return static_cast<int>(index);
  }
  Eigen::Index axis = 0;
  middles.sizes().maxCoeff(&axis);
  const std::size_t half = from + (to - from) / 2;
  const auto along = [&](int t) { return middle(triangles_[static_cast<std::size_t>(t)])[axis]; };
  const auto begin = order.begin();
  std::nth_element(begin + static_cast<std::ptrdiff_t>(from), begin + static_cast<std::ptrdiff_t>(half),
                   begin + static_cast<std::ptrdiff_t>(to), [&](int a, int b) {
                     return std::pair(along(a), a) < std::pair(along(b), b);  // one order, whatever the library's
                   });
  build(order, from, half);
  const int second = build(order, half, to);
  boxes_[index].second = second;
  return static_cast<int>(index);
}

struct TriangleTree::Search {
  const TriangleTree &one, &other;
  const Pose& T;
  Eigen::Matrix3d R, extent;  // of the other's axes in ours, and their absolute values
  Eigen::Vector3d t;
  Nearest best;

  // Squared. Written out: this is where the time goes, and it takes half of what expressions of vectors take.
  double at_least(const Box& a, const Box& b) const {
    double apart[3], along_ours = 0, along_theirs = 0;
    for (int i = 0; i < 3; ++i)
      apart[i] = R(i, 0) * b.center[0] + R(i, 1) * b.center[1] + R(i, 2) * b.center[2] + t[i] - a.center[i];
    for (int i = 0; i < 3; ++i) {
      const double ours = std::abs(apart[i]) - a.half[i] -
                          (extent(i, 0) * b.half[0] + extent(i, 1) * b.half[1] + extent(i, 2) * b.half[2]);
      const double theirs = std::abs(R(0, i) * apart[0] + R(1, i) * apart[1] + R(2, i) * apart[2]) - b.half[i] -
                            (extent(0, i) * a.half[0] + extent(1, i) * a.half[1] + extent(2, i) * a.half[2]);
      along_ours += ours > 0 ? ours * ours : 0;
      along_theirs += theirs > 0 ? theirs * theirs : 0;
    }
    return std::max(along_ours, along_theirs);
  }
  void descend(std::size_t a, std::size_t b) {
    const Box &x = one.boxes_[a], &y = other.boxes_[b];
    if (x.triangle >= 0 && y.triangle >= 0) {
      const Nearest found = one.between(other, T, {x.triangle, y.triangle});
      if (found.distance < best.distance) best = found;
      return;
    }
    const bool split_ours = y.triangle >= 0 || (x.triangle < 0 && x.size >= y.size);
    std::array<std::size_t, 2> first{a, b}, second{a, b};
    first[split_ours ? 0 : 1] += 1;
    second[split_ours ? 0 : 1] = static_cast<std::size_t>(split_ours ? x.second : y.second);
    double near = at_least(one.boxes_[first[0]], other.boxes_[first[1]]);
    double far = at_least(one.boxes_[second[0]], other.boxes_[second[1]]);
    if (far < near) {
      std::swap(near, far);
      std::swap(first, second);
    }
    if (near < best.distance * best.distance) descend(first[0], first[1]);
    if (far < best.distance * best.distance) descend(second[0], second[1]);
  }
};

TriangleTree::Nearest TriangleTree::between(const TriangleTree& other, const Pose& T,
                                            std::array<int, 2> pair) const noexcept {
  const Corners &a = triangles_[static_cast<std::size_t>(pair[0])],
                &b = other.triangles_[static_cast<std::size_t>(pair[1])];
  Nearest out;
  const Eigen::Vector3d ours[] = {a[0], a[1], a[2]}, theirs[] = {T * b[0], T * b[1], T * b[2]};
  out.distance =
      std::max(0.0, fcl::detail::TriangleDistance<double>::triDistance(ours, theirs, out.point, out.other_point));
  out.triangles = pair;
  return out;
}

double TriangleTree::at_least(const TriangleTree& other, const Pose& T) const noexcept {
  const Search search{*this, other, T, T.linear(), T.linear().cwiseAbs(), T.translation(), {}};
  return std::sqrt(search.at_least(boxes_[0], other.boxes_[0]));
}

TriangleTree::Nearest TriangleTree::nearest(const TriangleTree& other, const Pose& T, double beat) const noexcept {
  Search search{*this, other, T, T.linear(), T.linear().cwiseAbs(), T.translation(), {}};
  search.best.distance = beat;
  if (!boxes_.empty() && !other.boxes_.empty() && search.at_least(boxes_[0], other.boxes_[0]) < beat * beat)
    search.descend(0, 0);
  return search.best;
}

}  // namespace foresight
