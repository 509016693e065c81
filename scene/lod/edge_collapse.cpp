#include "scene/lod/edge_collapse.hpp"

#include <algorithm>
#include <limits>

namespace foresight {
namespace {

constexpr double kLine = 10;    // weight of a plane upright on an edge where parts meet, times the square of its length
constexpr double kFlat = 1e-6;  // of an edge's squared length: where all is flat, short edges go first
constexpr double kTurned = 0.25;  // cosine by which a triangle may turn in one collapse
constexpr double kSliver = 1e-3;  // area for the square of the longest side
constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kShare = 0.5;  // of a round's candidates that are looked at: the others wait for cheaper ones

}  // namespace

void EdgeCollapse::Quadric::add_plane(const Eigen::Vector3d& normal, const Eigen::Vector3d& point, double weight) {
  const double d = -normal.dot(point);
  A += weight * normal * normal.transpose();
  b += weight * d * normal;
  c += weight * d * d;
}

void EdgeCollapse::Quadric::add(const Quadric& other) {
  A += other.A;
  b += other.b;
  c += other.c;
  area += other.area;
}

double EdgeCollapse::Quadric::at(const Eigen::Vector3d& p) const {
  return area > 0 ? std::max(0.0, p.dot(A * p) + 2 * b.dot(p) + c) / area : 0;
}

EdgeCollapse::EdgeCollapse(const Mesh& mesh, std::span<const int> part_of) : part_of_(part_of) {
  // Near the origin quadrics keep their digits.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  if (!mesh.vertices.empty()) origin = mesh.vertices[0].cast<double>();
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    places_.push_back(mesh.vertices[v].cast<double>() - origin);
    to_.push_back(v);
  }
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& [a, b, c] = mesh.triangles[i];
    if (a != b && b != c && c != a) triangles_.push_back({mesh.triangles[i], i});
  }
  best_.resize(places_.size());
  touched_.assign(places_.size(), 1);
  list_triangles_of_vertices();
  find_quadrics();
}

void EdgeCollapse::find_quadrics() {
  quadrics_.resize(places_.size());
  const auto normal = [&](const Triangle& t) {
    return (places_[t.corners[1]] - places_[t.corners[0]]).cross(places_[t.corners[2]] - places_[t.corners[0]]);
  };
  for (const Triangle& t : triangles_) {
    const Eigen::Vector3d n = normal(t);
    const double area = n.norm();
    if (!(area > 0)) continue;
    for (const std::uint32_t v : t.corners) {
      quadrics_[v].add_plane(n / area, places_[t.corners[0]], area);
      quadrics_[v].area += area;
    }
  }
  for (std::uint32_t v = 0; v < places_.size(); ++v) {
    find_neighbours(v, ring_);
    for (const Neighbour& other : ring_) {
      if (!other.is_line()) continue;
      const Eigen::Vector3d along = places_[other.vertex] - places_[v];
      for (const std::uint32_t i : around(v)) {
        if (std::ranges::find(triangles_[i].corners, other.vertex) == triangles_[i].corners.end()) continue;
        const Eigen::Vector3d across = along.cross(normal(triangles_[i]));
        if (across.norm() > 0) quadrics_[v].add_plane(across.normalized(), places_[v], kLine * along.squaredNorm());
      }
    }
  }
}

void EdgeCollapse::list_triangles_of_vertices() {
  first_.assign(places_.size() + 1, 0);
  for (const Triangle& t : triangles_)
    for (const std::uint32_t v : t.corners) ++first_[v + 1];
  for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
  list_.resize(first_.back());
  for (std::uint32_t i = static_cast<std::uint32_t>(triangles_.size()); i-- > 0;)
    for (const std::uint32_t v : triangles_[i].corners) list_[--first_[v + 1]] = i;
  // Each entry has moved to where its list begins, one place too far.
  first_.erase(first_.begin());
  first_.push_back(static_cast<std::uint32_t>(list_.size()));
}

std::span<const std::uint32_t> EdgeCollapse::around(std::uint32_t vertex) const {
  return {list_.data() + first_[vertex], first_[vertex + 1] - first_[vertex]};
}

int EdgeCollapse::part(std::uint32_t triangle) const {
  return part_of_.empty() ? 0 : part_of_[triangles_[triangle].source];
}

void EdgeCollapse::find_neighbours(std::uint32_t vertex, std::vector<Neighbour>& out) const {
  out.clear();
  for (const std::uint32_t i : around(vertex))
    for (const std::uint32_t other : triangles_[i].corners) {
      if (other == vertex) continue;
      const auto known = std::ranges::find(out, other, &Neighbour::vertex);
      if (known == out.end()) {
        out.push_back({other, 1, part(i), part(i)});
      } else {
        ++known->triangles;
        known->other_part = part(i);
      }
    }
}

void EdgeCollapse::keep_allowed(std::vector<Neighbour>& neighbours) {
  std::array<const Neighbour*, 2> lines{};
  std::size_t count = 0;
  for (const Neighbour& n : neighbours) {
    if (!n.is_line()) continue;
    if (count == 2 || n.triangles > 2) return neighbours.clear();
    lines[count++] = &n;
  }
  if (count == 0) return;
  const auto label = [](const Neighbour& n) { return std::minmax(n.part, n.other_part); };
  const bool goes_on = count == 2 && lines[0]->triangles == lines[1]->triangles && label(*lines[0]) == label(*lines[1]);
  if (!goes_on) return neighbours.clear();
  std::erase_if(neighbours, [](const Neighbour& n) { return !n.is_line(); });
}

EdgeCollapse::Collapse EdgeCollapse::best_collapse(std::uint32_t vertex) {
  find_neighbours(vertex, ring_);
  keep_allowed(ring_);
  ways_.clear();
  for (const Neighbour& n : ring_) {
    const double length = (places_[n.vertex] - places_[vertex]).squaredNorm();
    ways_.push_back({quadrics_[vertex].at(places_[n.vertex]) + kFlat * length, vertex, n.vertex});
  }
  std::ranges::sort(ways_, {}, &Collapse::cost);
  const auto first = std::ranges::find_if(ways_, [&](const Collapse& way) { return !turns_over(vertex, way.to); });
  return first == ways_.end() ? Collapse{kNever, vertex, vertex} : *first;
}

/// Also where all of its triangles would vanish.
bool EdgeCollapse::turns_over(std::uint32_t from, std::uint32_t to) const {
  bool any_left = false;
  for (const std::uint32_t i : around(from)) {
    const auto& corners = triangles_[i].corners;
    if (std::ranges::find(corners, to) != corners.end()) continue;
    any_left = true;
    std::array<Eigen::Vector3d, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = places_[corners[k]];
    const Eigen::Vector3d before = (p[1] - p[0]).cross(p[2] - p[0]);
    for (std::size_t k = 0; k < 3; ++k)
      if (corners[k] == from) p[k] = places_[to];
    const Eigen::Vector3d after = (p[1] - p[0]).cross(p[2] - p[0]);
    const double longest =
        std::max({(p[1] - p[0]).squaredNorm(), (p[2] - p[1]).squaredNorm(), (p[0] - p[2]).squaredNorm()});
    if (after.dot(before) < kTurned * after.norm() * before.norm() || after.norm() < kSliver * longest) return true;
  }
  return !any_left;
}

/// Ends that share more neighbours than their edge has triangles would glue sheets together.
bool EdgeCollapse::glues(std::uint32_t from, std::uint32_t to) {
  find_neighbours(from, ring_);
  find_neighbours(to, other_ring_);
  int shared = 0, at_edge = 0;
  for (const Neighbour& n : ring_) {
    if (n.vertex == to) at_edge = n.triangles;
    shared += std::ranges::find(other_ring_, n.vertex, &Neighbour::vertex) != other_ring_.end();
  }
  return shared != at_edge;
}

std::size_t EdgeCollapse::round(std::size_t most, double largest_cost) {
  list_triangles_of_vertices();
  std::vector<Collapse> candidates;
  for (std::uint32_t v = 0; v < places_.size(); ++v) {
    if (around(v).empty()) continue;
    if (touched_[v]) best_[v] = best_collapse(v);  // for all others nothing has changed
    if (best_[v].cost <= largest_cost) candidates.push_back(best_[v]);
  }
  touched_.assign(places_.size(), 0);
  const auto looked_at = static_cast<std::ptrdiff_t>(kShare * static_cast<double>(candidates.size())) + 1;
  const auto end = candidates.begin() + std::min(looked_at, std::ssize(candidates));
  std::nth_element(candidates.begin(), end, candidates.end());
  std::sort(candidates.begin(), end);
  std::size_t gone = 0;
  for (auto c = candidates.begin(); c != end && gone < most; ++c) {
    if (touched_[c->from] || touched_[c->to] || glues(c->from, c->to)) continue;
    to_[c->from] = c->to;
    quadrics_[c->to].add(quadrics_[c->from]);
    // Whoever looks at one of these would see what is no longer so.
    touched_[c->from] = 1;
    for (const Neighbour& n : ring_) {
      touched_[n.vertex] = 1;
      if (n.vertex == c->to) gone += static_cast<std::size_t>(n.triangles);
    }
  }
  if (gone > 0) apply();
  return gone;
}

/// Gives triangles their new corners.
void EdgeCollapse::apply() {
  for (Triangle& t : triangles_)
    for (std::uint32_t& v : t.corners) v = to_[v];
  std::erase_if(triangles_, [](const Triangle& t) {
    return t.corners[0] == t.corners[1] || t.corners[1] == t.corners[2] || t.corners[2] == t.corners[0];
  });
}

bool EdgeCollapse::reduce_to(std::size_t triangles, double largest_error) {
  while (triangles_.size() > triangles)
    if (round(triangles_.size() - triangles, largest_error * largest_error) == 0) return false;
  return true;
}

std::uint32_t EdgeCollapse::vertex_of(std::uint32_t vertex) const {
  while (to_[vertex] != vertex) vertex = to_[vertex];
  return vertex;
}

}  // namespace foresight
