#include "sim/light_map.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

#include "sim/parallel.hpp"

namespace foresight::sim {
namespace {

using Eigen::Vector3f;

constexpr float kPi = std::numbers::pi_v<float>;
constexpr int kLampSide = 8;  // the lamp is kLampSide^2 points: one bit each in a 64-bit word
constexpr int kLampPoints = kLampSide * kLampSide;
constexpr int kStillRays = 96, kPlateRays = 40, kShadeRays = 16;
constexpr float kReach = 0.20f;  // metres around the plate within which its shadow is looked for
constexpr float kOffGeometry = 2e-4f, kOffRounded = 1e-3f;  // metres: no surface shades itself
constexpr float kHidden = 0.005f;                           // metres: what is covered this closely is hardly seen
constexpr float kBounce = 0.20f;  // light on the plate's surroundings while it is gathered, unlit part

const Vector3f kLampCentre(-0.62f, 0.95f, 1.45f), kLampTarget(0.05f, 0.0f, 0.0f);
const Vector3f kLampRadiance(24.0f, 21.9f, 18.6f);
constexpr float kLampSize = 0.62f;

struct Lamp {
  Vector3f normal, right, up;
  std::array<Vector3f, kLampPoints> points;
};

const Lamp& lamp() {
  static const Lamp built = [] {
    Lamp l;
    l.normal = (kLampTarget - kLampCentre).normalized();
    l.right = l.normal.cross(Vector3f::UnitZ()).normalized();
    l.up = l.right.cross(l.normal);
    for (int k = 0; k < kLampPoints; ++k) {
      const float x = (static_cast<float>(k % kLampSide) + 0.5f) / kLampSide - 0.5f;
      const float y = (static_cast<float>(k / kLampSide) + 0.5f) / kLampSide - 0.5f;
      l.points[k] = kLampCentre + kLampSize * (x * l.right + y * l.up);
    }
    return l;
  }();
  return built;
}

// Daylight: bright and cool from above and from the operator's side, where the windows are.
Vector3f daylight(const Vector3f& direction) {
  const float up = std::clamp(0.5f + 0.5f * direction.z(), 0.0f, 1.0f);
  const float window = std::pow(std::max(0.0f, direction.dot(Vector3f(-0.75f, -0.55f, 0.37f))), 3.0f);
  return (0.11f + 0.30f * up) * Vector3f(0.86f, 0.93f, 1.0f) + 0.7f * window * Vector3f(0.80f, 0.92f, 1.08f);
}

Vector3f from_lamp(const Vector3f& p, const Vector3f& n, std::uint64_t seen) {
  float sum = 0;
  for (; seen; seen &= seen - 1) {
    const Vector3f d = lamp().points[std::countr_zero(seen)] - p;
    const float r2 = d.squaredNorm();
    sum += std::max(0.0f, n.dot(d)) * std::max(0.0f, -lamp().normal.dot(d)) / (r2 * r2);
  }
  return sum * (kLampSize * kLampSize / kLampPoints) * kLampRadiance;
}

// The k-th of `count` directions about n, dense as the cosine (Malley's method on a spiral).
Vector3f cosine_direction(const Vector3f& n, int k, int count) {
  const float r2 = (static_cast<float>(k) + 0.5f) / static_cast<float>(count);
  const float angle = static_cast<float>(k) * kPi * (3 - std::sqrt(5.0f));
  const float r = std::sqrt(r2);
  // Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 2017.
  const float sign = std::copysign(1.0f, n.z()), a = -1 / (sign + n.z()), b = n.x() * n.y() * a;
  const Vector3f t(1 + sign * n.x() * n.x() * a, sign * b, -sign * n.x()), s(b, sign + n.y() * n.y() * a, -n.y());
  return r * std::cos(angle) * t + r * std::sin(angle) * s + std::sqrt(1 - r2) * n;
}

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

LightMap::LightMap(const Lab& lab, double coarser, const std::function<void()>& poll) {
  std::vector<Triangle> still;
  for (int k = 0; k < static_cast<int>(lab.parts.size()); ++k) {
    const Part& part = lab.parts[k];
    const bool moves = k == lab.plate;
    const int first = static_cast<int>(grids_.size());
    add_part(part, moves ? Pose::Identity() : part.T_world_part, coarser);
    for (const Facet& f : part.facets) albedo_.push_back(lab.materials[f.material].picture.mean());
    if (moves) {
      plate_first_ = first;
      plate_end_ = static_cast<int>(grids_.size());
      continue;
    }
    for (int facet = first; const Triangle& t : triangles_of(part, part.T_world_part.cast<float>())) {
      still_facets_.push_back(facet++);
      still.push_back(t);
    }
  }
  tracers_.emplace_back(std::move(still));
  tracers_.emplace_back(triangles_of(lab.parts[lab.plate], Eigen::Isometry3f::Identity()));

  seen_.assign(samples_.size(), 0);
  inside_.assign(samples_.size(), 0);
  direct_.assign(samples_.size(), Vector3f::Zero());
  ambient_ = direct_;
  const auto each_still_facet = [&](auto&& work) {
    parallel_for(still_facets_.size(), [&](std::size_t k) {
      const Grid& grid = grids_[still_facets_[k]];
      for (int i = grid.first; i < grid.first + (grid.n + 1) * (grid.n + 2) / 2; ++i) {
        if (poll && i % 64 == 0) poll();
        work(i);
      }
    });
  };
  each_still_facet([&](int i) {
    seen_[i] = lamp_points_seen(samples_[i]);
    direct_[i] = from_lamp(samples_[i].p, samples_[i].n, seen_[i]);
  });
  each_still_facet([&](int i) {
    const Gather g = gather(samples_[i], kStillRays, nullptr, Eigen::Isometry3f::Identity());
    ambient_[i] = g.light;
    inside_[i] = g.inside ||
                 tracers_[0].blocked(off_surface(samples_[i].p, samples_[i].n, samples_[i].g), samples_[i].g, kHidden);
  });
}

void LightMap::add_part(const Part& part, const Pose& T, double coarser) {
  const Eigen::Isometry3f Tf = T.cast<float>();
  for (const Facet& f : part.facets) {
    const auto& c = f.corners;
    const float longest = std::max({(c[1].p - c[0].p).norm(), (c[2].p - c[1].p).norm(), (c[0].p - c[2].p).norm()});
    const Vector3f area = Tf.linear() * (c[1].p - c[0].p).cross(c[2].p - c[0].p);
    // Slivers (chamfers) get their length's worth, not its square's.
    const double across = std::max(std::sqrt(area.norm()), longest / 8) / (part.light_step * coarser);
    const int n = std::clamp(static_cast<int>(std::ceil(across)), 1, 512);
    const Vector3f g = area.normalized();
    grids_.push_back({static_cast<int>(samples_.size()), n});
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i + j <= n; ++i) {
        const float b1 = static_cast<float>(i) / static_cast<float>(n),
                    b2 = static_cast<float>(j) / static_cast<float>(n);
        const float b0 = 1 - b1 - b2;
        samples_.push_back({Tf * (b0 * c[0].p + b1 * c[1].p + b2 * c[2].p),
                            (Tf.linear() * (b0 * c[0].n + b1 * c[1].n + b2 * c[2].n)).normalized(), g});
      }
  }
}

std::uint64_t LightMap::lamp_points_seen(const Sample& s) const {
  const Vector3f origin = off_surface(s.p, s.n, s.g);
  std::uint64_t seen = 0;
  for (int k = 0; k < kLampPoints; ++k) {
    const Vector3f d = lamp().points[k] - origin;
    if (s.n.dot(d) > 0 && !tracers_[0].blocked(origin, d, 1)) seen |= std::uint64_t{1} << k;
  }
  return seen;
}

LightMap::Gather LightMap::gather(const Sample& s, int rays, const Tracer* plate,
                                  const Eigen::Isometry3f& T_plate_world) const {
  const Vector3f origin = off_surface(s.p, s.n, s.g);
  Gather out;
  int behind = 0;
  for (int k = 0; k < rays; ++k) {
    const Vector3f d = cosine_direction(s.n, k, rays);
    if (plate && plate->blocked(T_plate_world * origin, T_plate_world.linear() * d, 10)) {
      out.light += Vector3f::Constant(0.5f * kBounce);
      continue;
    }
    const auto hit = tracers_[0].nearest(origin, d);
    if (!hit) {
      out.light += daylight(d);
      continue;
    }
    const int facet = still_facets_[hit->triangle];
    if (samples_[grids_[facet].first].g.dot(d) > 0) ++behind;
    const Vector3f lit = at(direct_, facet, hit->b1, hit->b2) + Vector3f::Constant(kBounce * kPi);
    out.light += albedo_[facet].cwiseProduct(lit) / kPi;
  }
  out.light *= kPi / static_cast<float>(rays);
  out.inside = 3 * behind > rays;
  return out;
}

// Samples inside a solid or under its chamfer are dark; interpolating them would draw a ragged seam along its foot.
// Their nearest usable neighbours speak for them.
void LightMap::fill(const Grid& grid, std::vector<std::uint8_t>& unusable, Irradiance& irradiance) const {
  constexpr int kNeighbours[6][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, -1}, {-1, 1}};
  for (int round = 0; round < 2; ++round) {
    std::vector<std::pair<int, Vector3f>> filled;
    for (int j = 0; j <= grid.n; ++j)
      for (int i = 0; i + j <= grid.n; ++i) {
        if (!unusable[grid.index(i, j)]) continue;
        Vector3f sum = Vector3f::Zero();
        int count = 0;
        for (const auto& d : kNeighbours) {
          const int a = i + d[0], b = j + d[1];
          if (a < 0 || b < 0 || a + b > grid.n || unusable[grid.index(a, b)]) continue;
          sum += irradiance[grid.index(a, b)];
          ++count;
        }
        if (count) filled.emplace_back(grid.index(i, j), sum / static_cast<float>(count));
      }
    for (const auto& [index, value] : filled) {
      irradiance[index] = value;
      unusable[index] = 0;
    }
  }
}

LightMap::Irradiance LightMap::with_plate_at(const Pose& T_world_plate) const {
  const Eigen::Isometry3f T = T_world_plate.cast<float>();
  Irradiance out(samples_.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = direct_[i] + ambient_[i];
  light_plate(T, out);
  shade_surroundings(T, out);
  return out;
}

void LightMap::light_plate(const Eigen::Isometry3f& T_world_plate, Irradiance& out) const {
  const Eigen::Isometry3f T_plate_world = T_world_plate.inverse();
  for (int f = plate_first_; f < plate_end_; ++f)
    for (int i = grids_[f].first; i < grids_[f].first + (grids_[f].n + 1) * (grids_[f].n + 2) / 2; ++i) {
      const Sample& own = samples_[i];
      const Sample s{T_world_plate * own.p, T_world_plate.linear() * own.n, T_world_plate.linear() * own.g};
      const Vector3f origin = off_surface(own.p, own.n, own.g);
      std::uint64_t seen = lamp_points_seen(s);
      for (std::uint64_t left = seen; left; left &= left - 1) {
        const int k = std::countr_zero(left);
        if (tracers_[1].blocked(origin, T_plate_world * lamp().points[k] - origin, 1)) seen &= ~(std::uint64_t{1} << k);
      }
      out[i] = from_lamp(s.p, s.n, seen) + gather(s, kPlateRays, &tracers_[1], T_plate_world).light;
    }
}

void LightMap::shade_surroundings(const Eigen::Isometry3f& T_world_plate, Irradiance& out) const {
  const Eigen::Isometry3f T_plate_world = T_world_plate.inverse();
  const Tracer& plate = tracers_[1];
  Eigen::AlignedBox3f reach(plate.bounds().min() - Vector3f::Constant(kReach),
                            plate.bounds().max() + Vector3f::Constant(kReach));
  std::array<Vector3f, kLampPoints> lamp_plate;
  for (int k = 0; k < kLampPoints; ++k) lamp_plate[k] = T_plate_world * lamp().points[k];

  std::vector<std::uint8_t> unusable = inside_;
  for (const int facet : still_facets_) {
    const Grid& grid = grids_[facet];
    for (int i = grid.first; i < grid.first + (grid.n + 1) * (grid.n + 2) / 2; ++i) {
      const Sample& s = samples_[i];
      if (inside_[i] || !reach.contains(T_plate_world * s.p)) continue;
      const Vector3f origin = T_plate_world * off_surface(s.p, s.n, s.g);
      if (plate.blocked(origin, T_plate_world.linear() * s.g, kHidden)) {
        unusable[i] = 1;
        continue;
      }
      std::uint64_t seen = seen_[i];
      for (std::uint64_t left = seen; left; left &= left - 1) {
        const int k = std::countr_zero(left);
        if (plate.blocked(origin, lamp_plate[k] - origin, 1)) seen &= ~(std::uint64_t{1} << k);
      }
      int shaded = 0;
      for (int k = 0; k < kShadeRays; ++k)
        shaded += plate.blocked(origin, T_plate_world.linear() * cosine_direction(s.n, k, kShadeRays), kReach);
      const float open = 1 - 0.7f * static_cast<float>(shaded) / kShadeRays;
      out[i] = (seen == seen_[i] ? direct_[i] : from_lamp(s.p, s.n, seen)) + open * ambient_[i];
    }
    fill(grid, unusable, out);
  }
}

Vector3f LightMap::at(const Irradiance& irradiance, int facet, float b1, float b2) const {
  const Grid& grid = grids_[facet];
  const auto n = static_cast<float>(grid.n);
  const float x = std::clamp(b1 * n, 0.0f, n), y = std::clamp(b2 * n, 0.0f, n - x);
  const int j = std::min(static_cast<int>(y), grid.n - 1);
  const int i = std::min(static_cast<int>(x), grid.n - 1 - j);
  const float a = x - static_cast<float>(i), b = y - static_cast<float>(j);
  const Vector3f& right = irradiance[grid.index(i + 1, j)];
  const Vector3f& below = irradiance[grid.index(i, j + 1)];
  if (a + b <= 1 || i + j + 2 > grid.n) return (1 - a - b) * irradiance[grid.index(i, j)] + a * right + b * below;
  return (a + b - 1) * irradiance[grid.index(i + 1, j + 1)] + (1 - b) * right + (1 - a) * below;
}

float LightMap::mirrored_lamp(const Vector3f& p, const Vector3f& n, const Vector3f& to_eye) {
  const Vector3f d = 2 * n.dot(to_eye) * n - to_eye;
  const float towards = -lamp().normal.dot(d);
  if (towards <= 0.05f) return 0;
  const Vector3f at = p + d * (lamp().normal.dot(p - kLampCentre) / towards) - kLampCentre;
  const auto edge = [](float x) {  // a slightly rough surface softens the lamp's border
    const float t = std::clamp((kLampSize * 0.62f - std::abs(x)) / (0.24f * kLampSize), 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
  };
  return edge(at.dot(lamp().right)) * edge(at.dot(lamp().up));
}

}  // namespace foresight::sim
