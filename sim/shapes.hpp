// Solids of the lab as painted triangles: boxes with chamfers, turned solids, a handle.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

namespace foresight::sim {

struct Corner {
  Eigen::Vector3f p;   ///< metres, node frame
  Eigen::Vector3f n;   ///< unit normal for shading; differs from the triangle's on rounded solids
  Eigen::Vector2f uv;  ///< metres on the material's picture, right and down
};

/// One triangle, counter-clockwise seen from outside.
struct Facet {
  std::array<Corner, 3> corners;
  int material = 0;
};

using Facets = std::vector<Facet>;

/// Materials of a box by side; `edge` paints the chamfers.
struct BoxPaint {
  int front = 0, back = 0, left = 0, right = 0, top = 0, bottom = 0, edge = 0;  ///< -x +x +y -y +z -z
  static BoxPaint all(int material) { return {material, material, material, material, material, material, material}; }
};

/// A box with its bottom centre at `base` and sides size.x() by size.y() by size.z(). A side's
/// picture starts at the side's top-left corner seen from outside (the top: seen with -x nearest).
void add_box(Facets& out, const Eigen::Vector3f& base, const Eigen::Vector3f& size, float chamfer,
             const BoxPaint& paint);

/// One rectangle: `corner` is the top-left of its picture, `right` and `down` its sides.
void add_rectangle(Facets& out, const Eigen::Vector3f& corner, const Eigen::Vector3f& right,
                   const Eigen::Vector3f& down, int material);

/// A point of a profile and the material of the band from it to the next point.
struct ProfilePoint {
  float radius, z;
  int material;
};

/// A solid of revolution about z through (0, 0). The profile runs from its bottom pole over the outside
/// to its upper end. u runs once around (2 pi times `picture_radius`, to the right seen from outside), v
/// downwards from `picture_top`.
void add_turned(Facets& out, const std::vector<ProfilePoint>& profile, int segments, float picture_radius,
                float picture_top);

/// Half a torus in the x-z plane that bulges towards +x: a mug's handle.
void add_handle(Facets& out, const Eigen::Vector3f& centre, float bow_radius, float tube_radius, int material);

/// Moves facets from their own frame into that of T's target.
void transform(Facets& facets, std::size_t first, const Eigen::Isometry3f& T);

}  // namespace foresight::sim
