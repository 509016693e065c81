#include "rig_view/drawing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace foresight {
namespace {

using Eigen::Vector3d;

constexpr double kTurn = 2 * std::numbers::pi;
constexpr int kAround = 24, kRings = 5;  // of a capsule, and of each of its caps

Vector3d turned(const Vector3d& axis, const Vector3d& zero, double angle) {
  return Eigen::AngleAxisd(angle, axis) * zero;
}

}  // namespace

void Drawing::line(const Vector3d& from, const Vector3d& to, const Colour& colour, float width_px) {
  lines.push_back({from.cast<float>(), to.cast<float>(), colour, width_px});
}

void Drawing::triangle(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Colour& colour) {
  for (const Vector3d& p : {a, b, c}) glass.push_back({p.cast<float>(), colour});
}

void Drawing::word(const Vector3d& at, std::string text, const Colour& colour) {
  words.push_back({at, std::move(text), colour});
}

void Drawing::box(const Eigen::AlignedBox3d& box, const Colour& edges, const Colour& sides, float width_px) {
  const auto corner = [&](int i) {
    return Vector3d(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)));  // bit k: the larger end of axis k
  };
  for (int i = 0; i < 8; ++i)
    for (int k = 1; k < 8; k *= 2)
      if (!(i & k)) line(corner(i), corner(i | k), edges, width_px);
  if (sides[3] <= 0) return;
  static constexpr int kSides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& s : kSides) {
    triangle(corner(s[0]), corner(s[1]), corner(s[2]), sides);
    triangle(corner(s[0]), corner(s[2]), corner(s[3]), sides);
  }
}

void Drawing::capsule(const Vector3d& a, const Vector3d& b, double radius, const Colour& colour) {
  const Vector3d along = (b - a).norm() > 1e-9 ? Vector3d((b - a).normalized()) : Vector3d::UnitZ();
  const Vector3d across = along.unitOrthogonal();
  // Rings from pole to pole: those of the cap at a, then those of the cap at b.
  const auto point = [&](int ring, int step) -> Vector3d {
    const bool far = ring > kRings;
    const double latitude = kTurn / 4 * (far ? ring - kRings - 1 : ring - kRings) / kRings;
    const Vector3d out = turned(along, across, kTurn * (step % kAround) / kAround);
    return (far ? b : a) + radius * (std::cos(latitude) * out + std::sin(latitude) * along);
  };
  for (int ring = 0; ring <= 2 * kRings; ++ring)
    for (int step = 0; step < kAround; ++step) {
      triangle(point(ring, step), point(ring, step + 1), point(ring + 1, step + 1), colour);
      triangle(point(ring, step), point(ring + 1, step + 1), point(ring + 1, step), colour);
    }
  const Colour edge = with_opacity(colour, std::min(1.0f, 2.2f * colour[3]));
  for (const int ring : {kRings, kRings + 1})
    for (int step = 0; step < kAround; ++step) line(point(ring, step), point(ring, step + 1), edge, 1);
  for (int step = 0; step < kAround; step += kAround / 4) line(point(kRings, step), point(kRings + 1, step), edge, 1);
}

void Drawing::arc(const Vector3d& centre, const Vector3d& axis, const Vector3d& zero, double radius, double from,
                  double to, const Colour& colour, float width_px) {
  const int steps = std::max(2, static_cast<int>(std::ceil(std::abs(to - from) / 0.08)));
  for (int i = 0; i < steps; ++i) {
    const auto at = [&](int k) -> Vector3d {
      return centre + radius * turned(axis, zero, from + (to - from) * k / steps);
    };
    line(at(i), at(i + 1), colour, width_px);
  }
}

void Drawing::axes(const Pose& T_world_frame, double length, float width_px) {
  for (int k = 0; k < 3; ++k) {
    Colour colour(0.10f, 0.10f, 0.10f, 1);
    colour[k] = k == 1 ? 0.60f : 0.85f;
    line(T_world_frame.translation(), T_world_frame * Vector3d(length * Vector3d::Unit(k)), colour, width_px);
  }
}

void Drawing::grid(const Pose& T_world_frame, double pitch, int steps, const Colour& colour) {
  const double end = pitch * steps;
  for (int i = -steps; i <= steps; ++i) {
    const float width = i % 5 == 0 ? 1.4f : 0.7f;
    line(T_world_frame * Vector3d(i * pitch, -end, 0), T_world_frame * Vector3d(i * pitch, end, 0), colour, width);
    line(T_world_frame * Vector3d(-end, i * pitch, 0), T_world_frame * Vector3d(end, i * pitch, 0), colour, width);
  }
}

}  // namespace foresight
