#include "sim/lamp.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace foresight::sim::lamp {
namespace {

using Eigen::Vector3f;

constexpr int kSide = 8;
static_assert(kSide * kSide == kPoints);
const Vector3f kCentre(0.02f, 0.46f, 1.60f), kTarget(-0.10f, 0.0f, 0.0f);
const Vector3f kRadiance(46.0f, 42.0f, 35.7f);
constexpr float kSize = 0.40f;

struct Lamp : Axes {
  std::array<Vector3f, kPoints> points;
};

const Lamp& lamp() {
  static const Lamp built = [] {
    Lamp l;
    l.normal = (kTarget - kCentre).normalized();
    l.right = l.normal.cross(Vector3f::UnitZ()).normalized();
    l.up = l.right.cross(l.normal);
    for (int k = 0; k < kPoints; ++k) {
      const float x = (static_cast<float>(k % kSide) + 0.5f) / kSide - 0.5f;
      const float y = (static_cast<float>(k / kSide) + 0.5f) / kSide - 0.5f;
      l.points[k] = kCentre + kSize * (x * l.right + y * l.up);
    }
    return l;
  }();
  return built;
}

}  // namespace

const Vector3f& centre() {
  return kCentre;
}

const Axes& axes() {
  return lamp();
}

float size() {
  return kSize;
}

const std::array<Vector3f, kPoints>& points() {
  return lamp().points;
}

Vector3f irradiance(const Vector3f& p, const Vector3f& n, std::uint64_t seen) {
  float sum = 0;
  for (; seen; seen &= seen - 1) {
    const Vector3f d = lamp().points[std::countr_zero(seen)] - p;
    const float r2 = d.squaredNorm();
    sum += std::max(0.0f, n.dot(d)) * std::max(0.0f, -lamp().normal.dot(d)) / (r2 * r2);
  }
  return sum * (kSize * kSize / kPoints) * kRadiance;
}

float mirrored(const Vector3f& p, const Vector3f& n, const Vector3f& to_eye) {
  const Vector3f d = 2 * n.dot(to_eye) * n - to_eye;
  const float towards = -lamp().normal.dot(d);
  if (towards <= 0.05f) return 0;
  const Vector3f at = p + d * (lamp().normal.dot(p - kCentre) / towards) - kCentre;
  const auto edge = [](float x) {  // a slightly rough surface softens the lamp's border
    const float t = std::clamp((kSize * 0.62f - std::abs(x)) / (0.24f * kSize), 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
  };
  return edge(at.dot(lamp().right)) * edge(at.dot(lamp().up));
}

// Bright and cool from above and from the operator's side, where the windows are.
Vector3f daylight(const Vector3f& direction) {
  const float up = std::clamp(0.5f + 0.5f * direction.z(), 0.0f, 1.0f);
  const float window = std::pow(std::max(0.0f, direction.dot(Vector3f(-0.75f, -0.55f, 0.37f))), 3.0f);
  return (0.11f + 0.30f * up) * Vector3f(0.86f, 0.93f, 1.0f) + 0.7f * window * Vector3f(0.80f, 0.92f, 1.08f);
}

}  // namespace foresight::sim::lamp
