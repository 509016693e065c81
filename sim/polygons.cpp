#include "sim/polygons.hpp"

#include <map>
#include <numeric>
#include <opencv2/imgproc.hpp>

namespace foresight::sim {
namespace {

using Eigen::Vector3d;

constexpr double kSamePlane = 1 - 2e-6;  // cosine between normals: 0.1 degrees

Vector3d area_of(const Facet& f) {
  const Vector3d a = f.corners[0].p.cast<double>();
  return 0.5 * (f.corners[1].p.cast<double>() - a).cross(f.corners[2].p.cast<double>() - a);
}

// Sets of facets, merged step by step.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  int root(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(int a, int b) { parent_[root(a)] = root(b); }

 private:
  std::vector<int> parent_;
};

bool is_convex(const Facets& facets, const std::vector<int>& face) {
  const Vector3d n = area_of(facets[face[0]]).normalized(), x = n.unitOrthogonal(), y = n.cross(x);
  std::vector<cv::Point2f> points, hull;
  double area = 0;
  const Vector3d origin = facets[face[0]].corners[0].p.cast<double>();
  for (int i : face) {
    area += area_of(facets[i]).norm();
    for (const Corner& c : facets[i].corners) {
      const Vector3d p = c.p.cast<double>() - origin;
      points.emplace_back(static_cast<float>(x.dot(p)), static_cast<float>(y.dot(p)));
    }
  }
  cv::convexHull(points, hull);
  return cv::contourArea(hull) < area * 1.001;
}

// Pairs of facets that share an edge and a plane.
std::vector<std::pair<int, int>> coplanar_neighbours(const Facets& facets) {
  using Place = std::array<float, 3>;
  std::map<std::pair<Place, Place>, int> edges;
  std::vector<std::pair<int, int>> out;
  const auto place = [](const Corner& c) { return Place{c.p.x(), c.p.y(), c.p.z()}; };
  for (int i = 0; i < static_cast<int>(facets.size()); ++i)
    for (int k = 0; k < 3; ++k) {
      const Place a = place(facets[i].corners[k]), b = place(facets[i].corners[(k + 1) % 3]);
      edges[{a, b}] = i;
      const auto other = edges.find({b, a});
      if (other != edges.end() &&
          area_of(facets[i]).normalized().dot(area_of(facets[other->second]).normalized()) > kSamePlane)
        out.emplace_back(other->second, i);
    }
  return out;
}

}  // namespace

Polygons polygons_of(const Lab& lab) {
  Polygons out;
  for (const Part& part : lab.parts) {
    const auto neighbours = coplanar_neighbours(part.facets);
    Sets faces(part.facets.size()), polygons(part.facets.size());
    for (const auto& [a, b] : neighbours) faces.join(a, b);
    std::map<int, std::vector<int>> members;
    for (int i = 0; i < static_cast<int>(part.facets.size()); ++i) members[faces.root(i)].push_back(i);
    for (const auto& [a, b] : neighbours)
      if (b == a + 1 || is_convex(part.facets, members[faces.root(a)])) polygons.join(a, b);
    std::map<int, int> numbers;
    for (int i = 0; i < static_cast<int>(part.facets.size()); ++i)
      out.of_facet.push_back(
          numbers.try_emplace(polygons.root(i), out.count + static_cast<int>(numbers.size())).first->second);
    out.count += static_cast<int>(numbers.size());
  }
  return out;
}

}  // namespace foresight::sim
