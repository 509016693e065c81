#include "sim/light_map.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <numbers>

#include "common/parallel.hpp"
#include "sim/hemisphere.hpp"
#include "sim/lamp.hpp"

namespace foresight::sim {
namespace {

using Eigen::Vector3f;

constexpr int kStillRays = 96, kMoverRays = 40, kShadeRays = 16;
constexpr float kReach = 0.25f;  // metres around what moves within which it shades the daylight
constexpr float kOffGeometry = 2e-4f, kOffRounded = 1e-3f;  // metres: no surface shades itself
constexpr float kHidden = 0.005f;                           // metres: what is covered this closely is hardly seen
constexpr float kSheet = 0.003f;                            // metres: what is thicker darkens its foot
constexpr float kFoot = 0.6f;                               // light that is left under the foot of a solid
constexpr float kBounce = 0.20f;                            // light on what is met while gathering, unlit part

Vector3f off_surface(const Vector3f& p, const Vector3f& n, const Vector3f& g) {
  const float rounded = n.dot(g) < 0.9999f ? kOffRounded : 0;
  return p + kOffGeometry * g + rounded * n;
}

std::vector<Triangle> triangles_of(const Part& part, const Eigen::Isometry3f& T) {
  std::vector<Triangle> out;
  for (const Facet& f : part.facets) out.push_back({T * f.corners[0].p, T * f.corners[1].p, T * f.corners[2].p});
  return out;
}

}  // namespace

// What moves, where it stands in one state.
struct LightMap::Movers {
  std::vector<Occluder> occluders;  // one per moving part
  std::vector<Vector3f> normals;    // of the tracer's triangles
  std::vector<int> facets;
  std::optional<Tracer> tracer;
};

LightMap::LightMap(const Lab& lab, double coarser, const std::function<void()>& poll) {
  std::vector<Triangle> still;
  for (int k = 0; k < static_cast<int>(lab.parts.size()); ++k) {
    const Part& part = lab.parts[k];
    const Range range = add_part(part, k, part.moves ? Pose::Identity() : part.T_world_part, coarser);
    for (const Facet& f : part.facets) albedo_.push_back(lab.materials[f.material].picture.mean());
    if (part.moves) {
      moving_.push_back(range);
      solids_.push_back(triangles_of(part, Eigen::Isometry3f::Identity()));
      continue;
    }
    still_.push_back(range);
    for (int facet = range.first_facet; const Triangle& t : triangles_of(part, part.T_world_part.cast<float>())) {
      still_facets_.push_back(facet++);
      still_g_.push_back((t[1] - t[0]).cross(t[2] - t[0]));
      still.push_back(t);
    }
  }
  still_tracer_.emplace(std::move(still));

  seen_.assign(samples_.size(), 0);
  inside_.assign(samples_.size(), 0);
  deep_ = inside_;
  direct_.assign(samples_.size(), Vector3f::Zero());
  ambient_ = direct_;
  std::vector<int> samples;
  for (const Range& range : still_)
    for (int i = range.first_sample; i < range.end_sample; ++i) samples.push_back(i);
  const auto each = [&](auto&& work) {
    constexpr std::size_t kChunk = 64;
    parallel_for((samples.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
      if (poll) poll();
      for (std::size_t k = chunk * kChunk; k < std::min(samples.size(), (chunk + 1) * kChunk); ++k) work(samples[k]);
    });
  };
  each([&](int i) {
    seen_[i] = lamp_points_seen(samples_[i]);
    direct_[i] = lamp::irradiance(samples_[i].p, samples_[i].n, seen_[i]);
  });
  each([&](int i) {
    const Sample& s = samples_[i];
    const Gather g = gather(s, kStillRays, nullptr);
    ambient_[i] = g.light;
    inside_[i] = g.inside || still_tracer_->blocked(off_surface(s.p, s.n, s.g), s.g, kHidden);
    const auto cover = still_tracer_->nearest(s.p + kSheet * s.g, s.g);
    deep_[i] = inside_[i] && cover && still_g_[cover->triangle].dot(s.g) > 0;
  });
}

LightMap::Range LightMap::add_part(const Part& part, int number, const Pose& T, double coarser) {
  Range range{number, static_cast<int>(samples_.size()), 0, static_cast<int>(grids_.size()), 0};
  const Eigen::Isometry3f Tf = T.cast<float>();
  std::map<std::array<int, 6>, int> known;  // place in 2 um, normal in 1e-2
  for (const Facet& f : part.facets) {
    const auto& c = f.corners;
    const float longest = std::max({(c[1].p - c[0].p).norm(), (c[2].p - c[1].p).norm(), (c[0].p - c[2].p).norm()});
    const Vector3f area = Tf.linear() * (c[1].p - c[0].p).cross(c[2].p - c[0].p);
    // Slivers (chamfers) get their length's worth, not its square's.
    const double across = std::max(std::sqrt(area.norm()), longest / 8) / (part.light_step * coarser);
    const int n = std::clamp(static_cast<int>(std::ceil(across)), 1, 512);
    const Vector3f g = area.normalized();
    grids_.push_back({static_cast<int>(grid_samples_.size()), n});
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i + j <= n; ++i) {
        const float b1 = static_cast<float>(i) / static_cast<float>(n),
                    b2 = static_cast<float>(j) / static_cast<float>(n);
        const float b0 = 1 - b1 - b2;
        const Vector3f p = b0 * c[0].p + b1 * c[1].p + b2 * c[2].p;
        const Vector3f m = (b0 * c[0].n + b1 * c[1].n + b2 * c[2].n).normalized();
        std::array<int, 6> key;
        for (int k = 0; k < 3; ++k) {
          key[k] = static_cast<int>(std::lround(p[k] * 5e5f));
          key[k + 3] = static_cast<int>(std::lround(m[k] * 1e2f));
        }
        const auto [at, is_new] = known.try_emplace(key, static_cast<int>(samples_.size()));
        grid_samples_.push_back(at->second);
        if (is_new)
          samples_.push_back({Tf * p, Tf.linear() * m, g});
        else if (samples_[at->second].g.dot(g) < 0.9999f)
          samples_[at->second].g = samples_[at->second].n;
      }
  }
  range.end_sample = static_cast<int>(samples_.size());
  range.end_facet = static_cast<int>(grids_.size());
  return range;
}

std::uint64_t LightMap::lamp_points_seen(const Sample& s) const {
  const Vector3f origin = off_surface(s.p, s.n, s.g);
  std::uint64_t seen = 0;
  for (int k = 0; k < lamp::kPoints; ++k) {
    const Vector3f d = lamp::points()[k] - origin;
    if (s.n.dot(d) > 0 && !still_tracer_->blocked(origin, d, 1)) seen |= std::uint64_t{1} << k;
  }
  return seen;
}

LightMap::Gather LightMap::gather(const Sample& s, int rays, const Movers* movers) const {
  const Vector3f origin = off_surface(s.p, s.n, s.g);
  Gather out;
  int behind = 0;
  for (int k = 0; k < rays; ++k) {
    const Vector3f d = cosine_direction(s.n, k, rays);
    const auto moving = movers ? movers->tracer->nearest(origin, d) : std::nullopt;
    const auto hit = moving ? still_tracer_->nearest(origin, d, moving->t) : still_tracer_->nearest(origin, d);
    if (moving && !hit) {
      if (movers->normals[moving->triangle].dot(d) > 0) ++behind;
      out.light += 2 * kBounce * albedo_[movers->facets[moving->triangle]];
      continue;
    }
    if (!hit) {
      out.light += lamp::daylight(d);
      continue;
    }
    const int facet = still_facets_[hit->triangle];
    if (still_g_[hit->triangle].dot(d) > 0) ++behind;
    const Vector3f lit = at(direct_, facet, hit->b1, hit->b2) + Vector3f::Constant(kBounce * std::numbers::pi_v<float>);
    out.light += albedo_[facet].cwiseProduct(lit) / std::numbers::pi_v<float>;
  }
  out.light *= std::numbers::pi_v<float> / static_cast<float>(rays);
  out.inside = 3 * behind > rays;
  return out;
}

// Samples inside a solid or under its chamfer are dark; interpolating them would draw a ragged seam along its foot.
// Their nearest usable neighbours speak for them, darker under a solid that stands there.
void LightMap::fill(const Grid& grid, std::vector<std::uint8_t>& unusable, Irradiance& irradiance) const {
  constexpr int kNeighbours[6][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, -1}, {-1, 1}};
  for (int round = 0; round < 2; ++round) {
    std::vector<std::pair<int, Vector3f>> filled;
    for (int j = 0; j <= grid.n; ++j)
      for (int i = 0; i + j <= grid.n; ++i) {
        if (!unusable[index(grid, i, j)]) continue;
        Vector3f sum = Vector3f::Zero();
        int count = 0;
        for (const auto& d : kNeighbours) {
          const int a = i + d[0], b = j + d[1];
          if (a < 0 || b < 0 || a + b > grid.n || unusable[index(grid, a, b)]) continue;
          sum += irradiance[index(grid, a, b)];
          ++count;
        }
        if (count)
          filled.emplace_back(index(grid, i, j),
                              sum * ((deep_[index(grid, i, j)] ? kFoot : 1) / static_cast<float>(count)));
      }
    for (const auto& [place, value] : filled) {
      irradiance[place] = value;
      unusable[place] = 0;
    }
  }
}

LightMap::Irradiance LightMap::lit(const LabState& T_world_part, int quicker) const {
  Irradiance out(samples_.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = direct_[i] + ambient_[i];
  if (moving_.empty()) {
    shade_still({}, kShadeRays, out);
    return out;
  }
  Movers movers;
  std::vector<Triangle> all;
  for (std::size_t m = 0; m < moving_.size(); ++m) {
    const Eigen::Isometry3f T = T_world_part[static_cast<std::size_t>(moving_[m].part)].cast<float>();
    std::vector<Triangle> placed = solids_[m];
    for (int facet = moving_[m].first_facet; Triangle & t : placed) {
      for (Vector3f& p : t) p = T * p;
      movers.normals.push_back((t[1] - t[0]).cross(t[2] - t[0]));
      movers.facets.push_back(facet++);
    }
    all.insert(all.end(), placed.begin(), placed.end());
    movers.occluders.emplace_back(placed);
  }
  movers.tracer.emplace(std::move(all));
  light_movers(T_world_part, movers, kMoverRays / quicker, out);
  shade_still(movers, kShadeRays / quicker, out);
  return out;
}

void LightMap::light_movers(const LabState& T_world_part, const Movers& movers, int rays_each, Irradiance& out) const {
  std::vector<std::uint8_t> unusable(samples_.size(), 0);
  for (const Range& range : moving_) {
    const Eigen::Isometry3f T = T_world_part[static_cast<std::size_t>(range.part)].cast<float>();
    for (int i = range.first_sample; i < range.end_sample; ++i) {
      const Sample s{T * samples_[i].p, T.linear() * samples_[i].n, T.linear() * samples_[i].g};
      const Gather g = gather(s, rays_each, &movers);
      unusable[i] = g.inside;
      std::uint64_t seen = g.inside ? 0 : lamp_points_seen(s);
      const LampRays rays(off_surface(s.p, s.n, s.g));
      for (const Occluder& occluder : movers.occluders)
        if (seen) seen &= ~occluder.hidden(rays, seen);
      out[i] = lamp::irradiance(s.p, s.n, seen) + g.light;
    }
    for (int f = range.first_facet; f < range.end_facet; ++f) fill(grids_[f], unusable, out);
  }
}

void LightMap::shade_still(const Movers& movers, int rays_each, Irradiance& out) const {
  std::vector<std::uint8_t> unusable = inside_;
  std::vector<Eigen::AlignedBox3f> reach;
  for (const Occluder& o : movers.occluders)
    reach.emplace_back(o.box().min() - Vector3f::Constant(kReach), o.box().max() + Vector3f::Constant(kReach));
  for (const Range& range : still_)
    for (int i = range.first_sample; i < range.end_sample; ++i) {
      if (inside_[i]) continue;
      const Sample& s = samples_[i];
      const Vector3f origin = off_surface(s.p, s.n, s.g);
      std::uint64_t seen = seen_[i];
      if (seen) {
        const LampRays rays(origin);
        for (const Occluder& occluder : movers.occluders) seen &= ~occluder.hidden(rays, seen);
      }
      float shaded = 0;
      if (std::any_of(reach.begin(), reach.end(), [&](const auto& box) { return box.contains(s.p); })) {
        if (movers.tracer->blocked(origin, s.g, kHidden)) {
          unusable[i] = 1;
          continue;
        }
        for (int k = 0; k < rays_each; ++k) {
          const auto hit = movers.tracer->nearest(origin, cosine_direction(s.n, k, rays_each), kReach);
          if (hit) shaded += (1 - hit->t / kReach) * (1 - hit->t / kReach);
        }
      }
      if (seen == seen_[i] && shaded == 0) continue;
      out[i] = (seen == seen_[i] ? direct_[i] : lamp::irradiance(s.p, s.n, seen)) +
               (1 - 0.85f * shaded / static_cast<float>(rays_each)) * ambient_[i];
    }
  for (const Range& range : still_)
    for (int f = range.first_facet; f < range.end_facet; ++f) fill(grids_[f], unusable, out);
}

Vector3f LightMap::at(const Irradiance& irradiance, int facet, float b1, float b2) const {
  const Grid& grid = grids_[facet];
  const auto n = static_cast<float>(grid.n);
  const float x = std::clamp(b1 * n, 0.0f, n), y = std::clamp(b2 * n, 0.0f, n - x);
  const int j = std::min(static_cast<int>(y), grid.n - 1);
  const int i = std::min(static_cast<int>(x), grid.n - 1 - j);
  const float a = x - static_cast<float>(i), b = y - static_cast<float>(j);
  const Vector3f& right = irradiance[index(grid, i + 1, j)];
  const Vector3f& below = irradiance[index(grid, i, j + 1)];
  if (a + b <= 1 || i + j + 2 > grid.n) return (1 - a - b) * irradiance[index(grid, i, j)] + a * right + b * below;
  return (a + b - 1) * irradiance[index(grid, i + 1, j + 1)] + (1 - b) * right + (1 - a) * below;
}

}  // namespace foresight::sim
