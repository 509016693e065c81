#include "texture_gpu/surface_patches.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <queue>
#include <set>
#include <utility>

#include "scene/solid.hpp"
#include "texture_gpu/mesh_topology.hpp"
#include "texture_gpu/overlap_grid.hpp"
#include "texture_gpu/polygons.hpp"

namespace foresight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Corners = std::array<Vector3d, 3>;

// While a patch grows its axis moves; a triangle that ends up steeper than this against the final
// axis is given back, so that texels are never stretched more than threefold.
constexpr double kSteepestCos = 0.35;

Vector3d any_perpendicular(const Vector3d& n) {
  const Vector3d axis = std::abs(n.x()) < 0.7 ? Vector3d::UnitX() : Vector3d::UnitY();
  return (axis - axis.dot(n) * n).normalized();
}

/// Grows one patch from `seed` over free triangles: the best aligned neighbour first.
std::vector<int> grow(int seed, double cos_cone, const std::vector<Face>& faces, std::vector<int>& owner, int id) {
  struct Candidate {
    double alignment;
    int triangle;
    bool operator<(const Candidate& o) const {
      return alignment != o.alignment ? alignment < o.alignment : triangle > o.triangle;
    }
  };
  std::vector<int> members;
  std::priority_queue<Candidate> front;
  Vector3d sum = Vector3d::Zero();
  front.push({1.0, seed});
  while (!front.empty()) {
    const int t = front.top().triangle;
    front.pop();
    const Face& face = faces[static_cast<std::size_t>(t)];
    if (owner[static_cast<std::size_t>(t)] >= 0) continue;
    if (!members.empty() && face.normal.dot(sum.normalized()) < cos_cone) continue;
    owner[static_cast<std::size_t>(t)] = id;
    members.push_back(t);
    sum += face.normal * face.area;
    const Vector3d axis = sum.normalized();
    for (int next : face.neighbours) {
      if (next < 0 || owner[static_cast<std::size_t>(next)] >= 0) continue;
      const double alignment = faces[static_cast<std::size_t>(next)].normal.dot(axis);
      if (alignment >= cos_cone) front.push({alignment, next});
    }
  }
  return members;
}

/// Axes in the plane across `n` that give the smallest bounding rectangle, tried in 3 degree steps.
std::pair<Vector3d, Vector3d> tightest_axes(const std::vector<int>& members, const std::vector<Corners>& corners,
                                            const Vector3d& n) {
  const Vector3d a = any_perpendicular(n), b = n.cross(a);
  std::pair<Vector3d, Vector3d> best{a, b};
  double best_area = std::numeric_limits<double>::max();
  for (int degrees = 0; degrees < 90; degrees += 3) {
    const double angle = degrees * std::numbers::pi / 180;
    const Vector3d eu = std::cos(angle) * a + std::sin(angle) * b, ev = n.cross(eu);
    Vector2d lower(1e300, 1e300), upper(-1e300, -1e300);
    for (int t : members)
      for (const Vector3d& p : corners[static_cast<std::size_t>(t)]) {
        const Vector2d uv(p.dot(eu), p.dot(ev));
        lower = lower.cwiseMin(uv);
        upper = upper.cwiseMax(uv);
      }
    const double area = (upper - lower).prod();
    if (area < best_area * (1 - 1e-9)) best_area = area, best = {eu, ev};
  }
  return best;
}

/// Builds patches from grown regions; triangles that do not fit are freed for a later region.
class Builder {
 public:
  Builder(const SceneModel& scene, const PatchOptions& options) : options_(options) {
    extent_ = options.chart_extent > 0 ? options.chart_extent : scene.diagonal() / 16;
    for (std::size_t n = 0; n < scene.nodes().size(); ++n) add_node(scene.nodes()[n].mesh, static_cast<int>(n));
    out_.patch_of_triangle.assign(faces_.size(), -1);
  }

  SurfacePatches run() {
    std::vector<int> seeds(faces_.size());
    std::iota(seeds.begin(), seeds.end(), 0);
    std::sort(seeds.begin(), seeds.end(), [&](int a, int b) {
      const double x = faces_[static_cast<std::size_t>(a)].area, y = faces_[static_cast<std::size_t>(b)].area;
      return x != y ? x > y : a < b;
    });
    const double cos_cone = std::cos(options_.cone_deg * std::numbers::pi / 180);
    // Each region keeps at least its seed, so this ends.
    for (int seed : seeds)
      while (out_.patch_of_triangle[static_cast<std::size_t>(seed)] < 0)
        add_patch(grow(seed, cos_cone, faces_, out_.patch_of_triangle, static_cast<int>(out_.patches.size())));
    link_charts();
    return std::move(out_);
  }

 private:
  void add_node(const Mesh& mesh, int node) {
    const int first = static_cast<int>(faces_.size());
    for (const auto& t : mesh.triangles) {
      Corners c;
      for (std::size_t i = 0; i < 3; ++i) c[i] = mesh.vertices[t[i]].cast<double>();
      const Vector3d cross = (c[1] - c[0]).cross(c[2] - c[0]);
      faces_.push_back({cross.normalized(), cross.norm() / 2});
      node_.push_back(node);
      out_.corners.push_back(c);
    }
    link_neighbours(mesh, first, faces_);
    Eigen::AlignedBox3d& body = bodies_.emplace_back();
    if (is_solid(mesh))
      for (const Eigen::Vector3f& v : mesh.vertices) body.extend(v.cast<double>());
  }

  void add_patch(std::vector<int> members) {
    Patch patch;
    const int seed = members.front();
    patch.node = node_[static_cast<std::size_t>(seed)];
    Vector3d sum = Vector3d::Zero();
    for (int t : members) sum += faces_[static_cast<std::size_t>(t)].normal * faces_[static_cast<std::size_t>(t)].area;
    patch.n = sum.normalized();
    // The seed must fit, or the region would never become smaller.
    if (faces_[static_cast<std::size_t>(seed)].normal.dot(patch.n) < kSteepestCos)
      patch.n = faces_[static_cast<std::size_t>(seed)].normal;
    std::tie(patch.eu, patch.ev) = tightest_axes(members, out_.corners, patch.n);
    release_misfits(patch, members);

    Vector2d lower(1e300, 1e300), upper(-1e300, -1e300);
    double h_sum = 0;
    for (int t : members)
      for (const Vector3d& p : out_.corners[static_cast<std::size_t>(t)]) {
        lower = lower.cwiseMin(uv(patch, p));
        upper = upper.cwiseMax(uv(patch, p));
        h_sum += p.dot(patch.n);
      }
    const double h = h_sum / (3.0 * static_cast<double>(members.size()));
    patch.origin = lower.x() * patch.eu + lower.y() * patch.ev + h * patch.n;
    patch.size = (upper - lower).cwiseMax(1e-6);
    patch.cells = (patch.size / extent_).array().ceil().max(1.0).cast<int>();
    patch.first_chart = static_cast<int>(out_.charts.size());
    out_.patches.push_back(patch);
    add_charts(members);
  }

  static Vector2d uv(const Patch& patch, const Vector3d& p) { return {p.dot(patch.eu), p.dot(patch.ev)}; }

  /// Frees members that are too steep or hide another member; what remains stays connected enough:
  /// charts need no connection, only a unique height.
  void release_misfits(const Patch& patch, std::vector<int>& members) {
    Vector2d lower(1e300, 1e300), upper(-1e300, -1e300);
    for (int t : members)
      for (const Vector3d& p : out_.corners[static_cast<std::size_t>(t)]) {
        lower = lower.cwiseMin(uv(patch, p));
        upper = upper.cwiseMax(uv(patch, p));
      }
    OverlapGrid grid(lower, upper, (upper - lower).norm() / 100);
    std::erase_if(members, [&](int t) {
      const Corners& c = out_.corners[static_cast<std::size_t>(t)];
      const bool fits = faces_[static_cast<std::size_t>(t)].normal.dot(patch.n) >= kSteepestCos &&
                        grid.claim({uv(patch, c[0]), uv(patch, c[1]), uv(patch, c[2])},
                                   {c[0].dot(patch.n), c[1].dot(patch.n), c[2].dot(patch.n)});
      if (!fits) out_.patch_of_triangle[static_cast<std::size_t>(t)] = -1;
      return !fits;
    });
  }

  void add_charts(const std::vector<int>& members) {
    const Patch& patch = out_.patches.back();
    const Vector2d cell = patch.cell_size();
    const auto count = static_cast<std::size_t>(patch.cells.prod());
    const std::size_t first = out_.charts.size();
    out_.charts.resize(first + count);
    const Vector2d border = cell / 16;  // texels beyond the cell's edge still need their triangle
    for (int t : members) {
      Vector2d lower(1e300, 1e300), upper(-1e300, -1e300);
      for (const Vector3d& p : out_.corners[static_cast<std::size_t>(t)]) {
        const Vector2d at = uv(patch, p - patch.origin);
        lower = lower.cwiseMin(at);
        upper = upper.cwiseMax(at);
      }
      const Eigen::Array2i from = ((lower - border).array() / cell.array()).floor().cast<int>().max(0);
      const Eigen::Array2i to =
          ((upper + border).array() / cell.array()).floor().cast<int>().min(patch.cells.array() - 1);
      for (int y = from.y(); y <= to.y(); ++y)
        for (int x = from.x(); x <= to.x(); ++x)
          add_triangle(out_.charts[first + static_cast<std::size_t>(y * patch.cells.x() + x)], t,
                       cell.cwiseProduct(Vector2d(x, y)), cell.cwiseProduct(Vector2d(x + 1, y + 1)), lower, upper);
    }
    for (std::size_t i = first; i < out_.charts.size(); ++i) finish(out_.charts[i]);
  }

  void add_triangle(Chart& chart, int t, const Vector2d& cell_lower, const Vector2d& cell_upper, const Vector2d& lower,
                    const Vector2d& upper) {
    const Vector2d l = lower.cwiseMax(cell_lower), u = upper.cwiseMin(cell_upper);
    if ((l.array() <= u.array()).all()) {
      const bool first = chart.radius == 0;
      chart.lower = first ? l : chart.lower.cwiseMin(l).eval();
      chart.upper = first ? u : chart.upper.cwiseMax(u).eval();
      chart.radius = 1;  // made exact by finish()
    }
    chart.triangles.push_back(static_cast<std::uint32_t>(t));
  }

  /// Bounding sphere of the part of the patch over the chart's rectangle.
  void finish(Chart& chart) {
    chart.patch = static_cast<int>(out_.patches.size()) - 1;
    if (chart.radius == 0) {
      chart.triangles.clear();
      return;
    }
    const Patch& patch = out_.patches.back();
    double h0 = 1e300, h1 = -1e300, slope2 = 0, area = 0, least_cosine = 1;
    for (std::uint32_t t : chart.triangles) {
      height_range(patch, chart, out_.corners[t], h0, h1);
      const double cosine = std::max(kSteepestCos, faces_[t].normal.dot(patch.n));
      least_cosine = std::min(least_cosine, faces_[t].normal.dot(patch.n));
      slope2 += faces_[t].area * (1 / (cosine * cosine) - 1);
      area += faces_[t].area;
    }
    chart.slope = std::sqrt(slope2 / area);
    chart.cone = std::acos(std::clamp(least_cosine, -1.0, 1.0));
    chart.body = bodies_[static_cast<std::size_t>(patch.node)];
    const Vector2d mid = (chart.lower + chart.upper) / 2;
    chart.center = patch.origin + mid.x() * patch.eu + mid.y() * patch.ev + (h0 + h1) / 2 * patch.n;
    chart.radius = std::max(1e-6, std::hypot((chart.upper - chart.lower).norm() / 2, (h1 - h0) / 2));
  }

  /// Heights of a triangle's plane over the rectangle, limited to the triangle's own heights.
  static void height_range(const Patch& patch, const Chart& chart, const Corners& c, double& h0, double& h1) {
    const Vector3d normal = (c[1] - c[0]).cross(c[2] - c[0]);
    double own0 = 1e300, own1 = -1e300, over0 = 1e300, over1 = -1e300;
    for (const Vector3d& p : c) {
      own0 = std::min(own0, (p - patch.origin).dot(patch.n));
      own1 = std::max(own1, (p - patch.origin).dot(patch.n));
    }
    for (int corner = 0; corner < 4; ++corner) {
      const Vector3d on_plane = patch.origin + (corner & 1 ? chart.upper : chart.lower).x() * patch.eu +
                                (corner & 2 ? chart.upper : chart.lower).y() * patch.ev;
      const double h = (c[0] - on_plane).dot(normal) / patch.n.dot(normal);
      over0 = std::min(over0, h);
      over1 = std::max(over1, h);
    }
    h0 = std::min(h0, std::max(own0, std::min(over0, own1)));
    h1 = std::max(h1, std::min(own1, std::max(over1, own0)));
  }

  int chart_at(int triangle, const Vector3d& p) const {
    const Patch& patch =
        out_.patches[static_cast<std::size_t>(out_.patch_of_triangle[static_cast<std::size_t>(triangle)])];
    const Eigen::Array2i cell = (uv(patch, p - patch.origin).array() / patch.cell_size().array())
                                    .floor()
                                    .cast<int>()
                                    .max(0)
                                    .min(patch.cells.array() - 1);
    return patch.first_chart + cell.y() * patch.cells.x() + cell.x();
  }

  /// Charts touch over a shared mesh edge, or side by side in one patch.
  void link_charts() {
    std::vector<std::set<int>> links(out_.charts.size());
    const auto link = [&](int a, int b) {
      const auto ok = [&](int i) { return out_.charts[static_cast<std::size_t>(i)].radius > 0; };
      if (a == b || !ok(a) || !ok(b)) return;
      links[static_cast<std::size_t>(a)].insert(b);
      links[static_cast<std::size_t>(b)].insert(a);
    };
    for (std::size_t t = 0; t < faces_.size(); ++t)
      for (std::size_t side = 0; side < 3; ++side) {
        const int other = faces_[t].neighbours[side];
        if (other < static_cast<int>(t)) continue;
        const Vector3d middle = (out_.corners[t][side] + out_.corners[t][(side + 1) % 3]) / 2;
        link(chart_at(static_cast<int>(t), middle), chart_at(other, middle));
      }
    for (const Patch& p : out_.patches)
      for (int y = 0; y < p.cells.y(); ++y)
        for (int x = 0; x < p.cells.x(); ++x) {
          const int at = p.first_chart + y * p.cells.x() + x;
          if (x + 1 < p.cells.x()) link(at, at + 1);
          if (y + 1 < p.cells.y()) link(at, at + p.cells.x());
        }
    for (std::size_t i = 0; i < links.size(); ++i) out_.charts[i].neighbours.assign(links[i].begin(), links[i].end());
  }

  PatchOptions options_;
  double extent_ = 1;
  std::vector<Face> faces_;
  std::vector<int> node_;
  std::vector<Eigen::AlignedBox3d> bodies_;  // per node; empty where it is not solid
  SurfacePatches out_;
};

/// Sets Chart::polygon.
void measure_polygons(const SceneModel& scene, SurfacePatches& out) {
  const std::vector<Polygon> polygons = find_polygons(scene);
  std::vector<const Polygon*> polygon_of(out.corners.size());
  for (const Polygon& polygon : polygons)
    for (std::uint32_t t : polygon.scene_triangles) polygon_of[t] = &polygon;
  for (Chart& chart : out.charts) {
    const Patch& patch = out.patches[static_cast<std::size_t>(chart.patch)];
    const Polygon* last = nullptr;
    for (std::uint32_t t : chart.triangles) {
      const Polygon* polygon = polygon_of[t];
      if (!polygon || std::exchange(last, polygon) == polygon) continue;
      Vector2d low(1e300, 1e300), high = -low;
      for (const Vector3d& corner : polygon->corners) {
        const Vector2d at(corner.dot(patch.eu), corner.dot(patch.ev));
        low = low.cwiseMin(at);
        high = high.cwiseMax(at);
      }
      chart.polygon = chart.polygon.cwiseMax(high - low);
    }
  }
}

}  // namespace

SurfacePatches find_surface_patches(const SceneModel& scene, const PatchOptions& options) {
  SurfacePatches out = Builder(scene, options).run();
  measure_polygons(scene, out);
  return out;
}

}  // namespace foresight
