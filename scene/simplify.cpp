#include "scene/simplify.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <map>
#include <queue>

namespace foresight {
namespace {

using Eigen::Vector3d;

constexpr double kBorder = 10;  // times its edge's square, as area

/// Mean of the squared distances to planes, as a function of the point.
struct Quadric {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Vector3d b = Vector3d::Zero();
  double c = 0, area = 0;

  void add_plane(const Vector3d& normal, const Vector3d& point, double weight) {
    const double d = -normal.dot(point);
    A += weight * normal * normal.transpose();
    b += weight * d * normal;
    c += weight * d * d;
  }
  Quadric operator+(const Quadric& other) const { return {A + other.A, b + other.b, c + other.c, area + other.area}; }
  double at(const Vector3d& p) const { return std::max(0.0, p.dot(A * p) + 2 * b.dot(p) + c) / area; }
};

class Simplifier {
 public:
  Simplifier(const Mesh& mesh, double tolerance) : mesh_(mesh), most_(tolerance * tolerance) {
    for (const auto& v : mesh.vertices) places_.push_back(v.cast<double>());
    origin_ = places_.empty() ? Vector3d::Zero() : places_[0];  // near it, quadrics keep their digits
    for (Vector3d& p : places_) p -= origin_;
    triangles_ = mesh.triangles;
    quadrics_.resize(places_.size());
    versions_.resize(places_.size());
    around_.resize(places_.size());
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      const Vector3d n = normal(triangles_[t]);
      for (const std::uint32_t v : triangles_[t]) {
        around_[v].push_back(t);
        quadrics_[v].add_plane(n.normalized(), places_[triangles_[t][0]], n.norm());
        quadrics_[v].area += n.norm();
      }
    }
    hold_borders();
  }

  Mesh run() {
    for (std::uint32_t v = 0; v < places_.size(); ++v)
      for (const std::uint32_t other : neighbours(v))
        if (v < other) consider(v, other);
    while (!queue_.empty()) {
      const Candidate next = queue_.top();
      queue_.pop();
      if (next.version == versions_[next.keep] + versions_[next.drop] && !gone(next.keep) && !gone(next.drop))
        collapse(next);
    }
    return result();
  }

 private:
  struct Candidate {
    double cost;
    std::uint32_t keep, drop;
    std::uint64_t version;  // of both ends; a newer one makes this void
    Vector3d place;
    bool operator<(const Candidate& other) const {  // the queue's top is the cheapest
      return std::tie(cost, keep, drop) > std::tie(other.cost, other.keep, other.drop);
    }
  };
  using Triangle = std::array<std::uint32_t, 3>;

  bool gone(std::uint32_t v) const { return around_[v].empty(); }
  Vector3d normal(const Triangle& t) const {
    return (places_[t[1]] - places_[t[0]]).cross(places_[t[2]] - places_[t[0]]);
  }
  std::vector<std::uint32_t> neighbours(std::uint32_t v) const {
    std::vector<std::uint32_t> out;
    for (const std::uint32_t t : around_[v])
      for (const std::uint32_t other : triangles_[t])
        if (other != v) out.push_back(other);
    std::ranges::sort(out);
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  }

  /// A plane upright on each edge that has one triangle, or more than two; it counts much, and not as area.
  void hold_borders() {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<int, std::uint32_t>> edges;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [a, b] = std::minmax(triangles_[t][k], triangles_[t][(k + 1) % 3]);
        auto& edge = edges[{a, b}];
        ++edge.first;
        edge.second = t;
      }
    for (const auto& [ends, edge] : edges) {
      if (edge.first == 2) continue;
      const Vector3d along = places_[ends.second] - places_[ends.first];
      const Vector3d across = along.cross(normal(triangles_[edge.second])).normalized();
      for (const std::uint32_t v : {ends.first, ends.second})
        quadrics_[v].add_plane(across, places_[ends.first], kBorder * along.squaredNorm());
    }
  }

  void consider(std::uint32_t keep, std::uint32_t drop) {
    const Quadric sum = quadrics_[keep] + quadrics_[drop];
    const Vector3d middle = 0.5 * (places_[keep] + places_[drop]);
    Vector3d best = middle;
    for (const Vector3d& p : {places_[keep], places_[drop]})
      if (sum.at(p) < sum.at(best)) best = p;
    // Where planes of three directions meet, their corner; held to the edge, as nearly parallel ones meet far away.
    const double hold = 1e-6 * sum.area;
    const Eigen::LDLT<Eigen::Matrix3d> solver(sum.A + hold * Eigen::Matrix3d::Identity());
    const Vector3d corner = solver.solve(hold * middle - sum.b);
    if ((corner - middle).norm() < 2 * (places_[keep] - places_[drop]).norm() && sum.at(corner) < sum.at(best))
      best = corner;
    const double cost = sum.at(best);
    if (cost <= most_) queue_.push({cost, keep, drop, versions_[keep] + versions_[drop], best});
  }

  /// Would a triangle of `v` turn over or become a sliver if `v` went to `place`? Those that hold `other` vanish.
  bool spoils(std::uint32_t v, std::uint32_t other, const Vector3d& place) const {
    return std::ranges::any_of(around_[v], [&](std::uint32_t t) {
      const Triangle& triangle = triangles_[t];
      if (std::ranges::find(triangle, other) != triangle.end()) return false;
      std::array<Vector3d, 3> p;
      for (std::size_t k = 0; k < 3; ++k) p[k] = triangle[k] == v ? place : places_[triangle[k]];
      const Vector3d after = (p[1] - p[0]).cross(p[2] - p[0]), before = normal(triangle);
      const double longest =
          std::max({(p[1] - p[0]).squaredNorm(), (p[2] - p[1]).squaredNorm(), (p[0] - p[2]).squaredNorm()});
      return after.dot(before) < 0.3 * after.norm() * before.norm() || after.norm() < 1e-3 * longest;
    });
  }

  /// Collapsing an edge whose ends share more neighbours than it has triangles would glue sheets together.
  bool pinches(std::uint32_t keep, std::uint32_t drop) const {
    const auto a = neighbours(keep), b = neighbours(drop);
    std::vector<std::uint32_t> both;
    std::ranges::set_intersection(a, b, std::back_inserter(both));
    const auto shared = std::ranges::count_if(
        around_[keep], [&](std::uint32_t t) { return std::ranges::find(triangles_[t], drop) != triangles_[t].end(); });
    return static_cast<std::ptrdiff_t>(both.size()) != shared;
  }

  void collapse(const Candidate& c) {
    if (pinches(c.keep, c.drop) || spoils(c.keep, c.drop, c.place) || spoils(c.drop, c.keep, c.place)) return;
    places_[c.keep] = c.place;
    quadrics_[c.keep] = quadrics_[c.keep] + quadrics_[c.drop];
    for (const std::uint32_t t : around_[c.drop]) {
      Triangle& triangle = triangles_[t];
      if (std::ranges::find(triangle, c.keep) != triangle.end()) {
        for (const std::uint32_t v : triangle)
          if (v != c.drop) std::erase(around_[v], t);
        triangle = {0, 0, 0};
        continue;
      }
      std::ranges::replace(triangle, c.drop, c.keep);
      around_[c.keep].push_back(t);
    }
    around_[c.drop].clear();
    ++versions_[c.drop];
    ++versions_[c.keep];
    for (const std::uint32_t other : neighbours(c.keep)) consider(c.keep, other);
  }

  Mesh result() const {
    Mesh out;
    out.dropped_degenerate = mesh_.dropped_degenerate;
    std::vector<std::uint32_t> index(places_.size());
    for (std::size_t v = 0; v < places_.size(); ++v) {
      if (around_[v].empty()) continue;
      index[v] = static_cast<std::uint32_t>(out.vertices.size());
      out.vertices.push_back((places_[v] + origin_).cast<float>());
    }
    for (const Triangle& t : triangles_)
      if (t[0] != t[1]) out.triangles.push_back({index[t[0]], index[t[1]], index[t[2]]});
    return out;
  }

  const Mesh& mesh_;
  const double most_;
  Vector3d origin_;
  std::vector<Vector3d> places_;
  std::vector<Triangle> triangles_;
  std::vector<Quadric> quadrics_;
  std::vector<std::uint64_t> versions_;
  std::vector<std::vector<std::uint32_t>> around_;  // triangles of each vertex; none: it is gone
  std::priority_queue<Candidate> queue_;
};

}  // namespace

Mesh simplified(const Mesh& mesh, double tolerance) {
  return Simplifier(mesh, tolerance).run();
}

}  // namespace foresight
