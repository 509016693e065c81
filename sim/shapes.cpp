#include "sim/shapes.hpp"

#include <cmath>
#include <numbers>

namespace foresight::sim {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

// A face frame of a box: outward normal, and right and up of its picture.
struct Face {
  Vector3f n, right, up;
};

std::array<Face, 6> faces() {
  const Vector3f x = Vector3f::UnitX(), y = Vector3f::UnitY(), z = Vector3f::UnitZ();
  return {{{-x, -y, z}, {x, y, z}, {y, -x, z}, {-y, x, z}, {z, -y, x}, {-z, -y, -x}}};
}

void add_flat(Facets& out, const std::array<Vector3f, 3>& p, Vector3f outwards, int material) {
  Facet facet;
  facet.material = material;
  Vector3f n = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
  const bool flip = n.dot(outwards) < 0;
  if (flip) n = -n;
  for (int k = 0; k < 3; ++k) facet.corners[k] = {p[flip ? 2 - k : k], n, Vector2f::Zero()};
  out.push_back(facet);
}

// Corners a b / d c of a quad, counter-clockwise; drops the triangle that a pole collapses.
void add_quad(Facets& out, const Corner& a, const Corner& b, const Corner& c, const Corner& d, int material) {
  if (a.p != b.p) out.push_back({{a, b, c}, material});
  if (c.p != d.p) out.push_back({{a, c, d}, material});
}

void add_chamfers(Facets& out, const Vector3f& centre, const Vector3f& half, float chamfer, int material) {
  const Vector3f inner = half - Vector3f::Constant(chamfer);
  const auto vertex = [&](const Vector3f& sign, int face_axis) {
    Vector3f p = inner;
    p[face_axis] = half[face_axis];
    return Vector3f(centre + sign.cwiseProduct(p));
  };
  for (int k = 0; k < 8; ++k) {
    const Vector3f sign(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
    add_flat(out, {vertex(sign, 0), vertex(sign, 1), vertex(sign, 2)}, sign, material);
    for (int axis = 0; axis < 3; ++axis) {
      if (sign[axis] > 0) continue;  // each edge once, from its lower end
      Vector3f other = sign;
      other[axis] = 1;
      const int a = (axis + 1) % 3, b = (axis + 2) % 3;
      Vector3f outwards = sign;
      outwards[axis] = 0;
      add_flat(out, {vertex(sign, a), vertex(sign, b), vertex(other, a)}, outwards, material);
      add_flat(out, {vertex(other, a), vertex(sign, b), vertex(other, b)}, outwards, material);
    }
  }
}

}  // namespace

void add_box(Facets& out, const Vector3f& base, const Vector3f& size, float chamfer, const BoxPaint& paint) {
  const Vector3f half = size / 2, centre = base + Vector3f(0, 0, half.z());
  const int materials[] = {paint.front, paint.back, paint.left, paint.right, paint.top, paint.bottom};
  int side = 0;
  for (const Face& f : faces()) {
    const float depth = f.n.cwiseAbs().dot(half);
    const float w = f.right.cwiseAbs().dot(half), h = f.up.cwiseAbs().dot(half);
    const auto corner = [&](float x, float y) {
      const float u = x * (w - chamfer), v = y * (h - chamfer);
      return Corner{centre + depth * f.n + u * f.right + v * f.up, f.n, {u + w, h - v}};
    };
    add_quad(out, corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1), materials[side++]);
  }
  if (chamfer > 0) add_chamfers(out, centre, half, chamfer, paint.edge);
}

void add_rectangle(Facets& out, const Vector3f& corner, const Vector3f& right, const Vector3f& down, int material) {
  const Vector3f n = down.cross(right).normalized();
  const float w = right.norm(), h = down.norm();
  add_quad(out, {corner + down, n, {0, h}}, {corner + down + right, n, {w, h}}, {corner + right, n, {w, 0}},
           {corner, n, {0, 0}}, material);
}

void add_turned(Facets& out, const std::vector<ProfilePoint>& profile, int segments, float picture_radius,
                float picture_top) {
  const int bands = static_cast<int>(profile.size()) - 1;
  const auto band_normal = [&](int i) {  // (radial, z)
    const float dr = profile[i + 1].radius - profile[i].radius, dz = profile[i + 1].z - profile[i].z;
    return Vector2f(dz, -dr).normalized();
  };
  // Neighbouring bands share a normal unless they meet at a crease.
  const auto corner_normal = [&](int band, int neighbour) {
    const Vector2f own = band_normal(band);
    if (neighbour < 0 || neighbour >= bands || own.dot(band_normal(neighbour)) < 0.7f) return own;
    return Vector2f((own + band_normal(neighbour)).normalized());
  };
  const auto corner = [&](const ProfilePoint& at, const Vector2f& n, int segment) {
    const float angle =
        2 * std::numbers::pi_v<float> * static_cast<float>(segment % segments) / static_cast<float>(segments);
    const float u =
        2 * std::numbers::pi_v<float> * static_cast<float>(segment) / static_cast<float>(segments) * picture_radius;
    const float c = std::cos(angle), s = std::sin(angle);
    return Corner{{at.radius * c, at.radius * s, at.z}, {n.x() * c, n.x() * s, n.y()}, {u, picture_top - at.z}};
  };
  for (int band = 0; band < bands; ++band) {
    const Vector2f low = corner_normal(band, band - 1), high = corner_normal(band, band + 1);
    for (int k = 0; k < segments; ++k)
      add_quad(out, corner(profile[band], low, k), corner(profile[band], low, k + 1),
               corner(profile[band + 1], high, k + 1), corner(profile[band + 1], high, k), profile[band].material);
  }
}

void add_handle(Facets& out, const Vector3f& centre, float bow_radius, float tube_radius, int material) {
  constexpr int kAlong = 8, kAround = 6;
  const auto corner = [&](int i, int j) {
    const float bow = std::numbers::pi_v<float> * (static_cast<float>(i) / kAlong - 0.5f);
    const float around = 2 * std::numbers::pi_v<float> * static_cast<float>(j % kAround) / kAround;
    const Vector3f out_dir(std::cos(bow), 0, std::sin(bow));
    const Vector3f n = std::cos(around) * out_dir + std::sin(around) * Vector3f::UnitY();
    return Corner{centre + bow_radius * out_dir + tube_radius * n, n, {0, 0}};
  };
  for (int i = 0; i < kAlong; ++i)
    for (int j = 0; j < kAround; ++j)
      add_quad(out, corner(i, j), corner(i, j + 1), corner(i + 1, j + 1), corner(i + 1, j), material);
  for (int i : {0, kAlong}) {  // lids
    const Corner middle{centre + Vector3f(0, 0, i ? bow_radius : -bow_radius), -Vector3f::UnitX(), {0, 0}};
    for (int j = 0; j < kAround; ++j)
      out.push_back({{middle, corner(i, i ? j : j + 1), corner(i, i ? j + 1 : j)}, material});
  }
}

void transform(Facets& facets, std::size_t first, const Eigen::Isometry3f& T) {
  for (std::size_t i = first; i < facets.size(); ++i)
    for (Corner& c : facets[i].corners) {
      c.p = T * c.p;
      c.n = T.linear() * c.n;
    }
}

}  // namespace foresight::sim
