#include "scene/primitives.hpp"

#include <Eigen/Geometry>
#include <numbers>

#include "scene/mesh_builder.hpp"

namespace foresight {
namespace {

constexpr int kAround = 32;
constexpr int kRings = 16;

// The same float for step 0 and step kAround, so that the seam welds.
Eigen::Vector3f on_circle(double radius, int step, double z) {
  const double angle = 2 * std::numbers::pi * (step % kAround) / kAround;
  return Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), z).cast<float>();
}

void add(MeshBuilder& builder, std::initializer_list<Eigen::Vector3f> corners) {
  builder.add({corners.begin(), corners.size()});
}

}  // namespace

Mesh make_box(const Eigen::Vector3d& size) {
  // Corner i has the sign of bit k on axis k; faces counter-clockwise from outside.
  static constexpr int kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  const auto corner = [&](int i) {
    return Eigen::Vector3f(
        (Eigen::Vector3d((i & 1) - 0.5, (i >> 1 & 1) - 0.5, (i >> 2 & 1) - 0.5).cwiseProduct(size)).cast<float>());
  };
  MeshBuilder builder;
  for (const auto& f : kFaces) add(builder, {corner(f[0]), corner(f[1]), corner(f[2]), corner(f[3])});
  return std::move(builder).take();
}

Mesh make_cylinder(double radius, double length) {
  MeshBuilder builder;
  const double z = length / 2;
  const Eigen::Vector3f bottom(0, 0, static_cast<float>(-z)), top(0, 0, static_cast<float>(z));
  for (int i = 0; i < kAround; ++i) {
    const auto a = on_circle(radius, i, -z), b = on_circle(radius, i + 1, -z);
    const auto c = on_circle(radius, i + 1, z), d = on_circle(radius, i, z);
    add(builder, {a, b, c});
    add(builder, {a, c, d});
    add(builder, {bottom, b, a});
    add(builder, {top, d, c});
  }
  return std::move(builder).take();
}

Mesh make_sphere(double radius) {
  MeshBuilder builder;
  const auto point = [&](int ring, int step) {
    if (ring == 0 || ring == kRings) return Eigen::Vector3f(0, 0, static_cast<float>(ring == 0 ? -radius : radius));
    const double latitude = std::numbers::pi * (static_cast<double>(ring) / kRings - 0.5);
    return on_circle(radius * std::cos(latitude), step, radius * std::sin(latitude));
  };
  for (int ring = 0; ring < kRings; ++ring) {
    for (int i = 0; i < kAround; ++i) {
      const auto a = point(ring, i), b = point(ring, i + 1), c = point(ring + 1, i + 1), d = point(ring + 1, i);
      if (ring > 0) add(builder, {a, b, c});           // a == b at the lower pole
      if (ring + 1 < kRings) add(builder, {a, c, d});  // c == d at the upper
    }
  }
  return std::move(builder).take();
}

}  // namespace foresight
