// Divides the surface of a scene into patches that can carry a texture.
//
// A patch is a connected set of triangles that is a height field over a plane: seen along the
// plane's normal, no part hides another. A point of the surface is then found from its place
// (u, v) on the plane and one height, and (u, v) from the point by two dot products:
//
//     p_node = origin + u eu + v ev + h n          h
//                                                __|__/\___   surface
//     u = (p_node - origin) . eu                 ----------   plane, u to the right
//
// Large patches are divided into a grid of cells; each non-empty cell is a chart, the unit that
// has a resolution of its own (docs/decisions/0004-height-field-charts.md).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "scene/scene_model.hpp"

namespace foresight {

struct PatchOptions {
  double cone_deg = 60;     ///< largest angle between a triangle and its patch's axis while growing
  double chart_extent = 0;  ///< largest side of a chart, metres; 0: a sixteenth of the scene's diagonal
};

struct Patch {
  int node = 0;
  Eigen::Vector3d origin, eu, ev, n;  ///< node frame; eu, ev, n are right-handed and of unit length
  Eigen::Vector2d size;               ///< extent in u and v, metres; the patch spans [0, size]
  Eigen::Vector2i cells;              ///< grid of charts
  int first_chart = 0;                ///< chart of cell (0, 0); cells in row-major order
  Eigen::Vector2d cell_size() const { return size.cwiseQuotient(cells.cast<double>()); }
};

/// One cell of one patch.
struct Chart {
  int patch = 0;
  Eigen::Vector2d lower, upper;          ///< what its triangles cover in the patch's (u, v), metres
  std::vector<std::uint32_t> triangles;  ///< of the whole scene; all that reach into the cell or its border
  Eigen::Vector3d center;                ///< of the bounding sphere, node frame
  double radius = 0;                     ///< metres; 0: an empty cell
  double slope = 0;                      ///< rms slope of its triangles against the patch's plane
  double cone = 0;                       ///< largest angle of a triangle's normal from the patch's, radians
  Eigen::Vector2d polygon{0, 0};         ///< longest flat polygon on it along u and along v, metres
  Eigen::AlignedBox3d body;              ///< of the watertight mesh that it is part of, node frame; else empty
  std::vector<int> neighbours;           ///< charts that touch this one

  bool closed() const { return !body.isEmpty(); }
  /// Whether a view from `eye`, node frame, may see its back: of a body's, only one from within, as of a room's walls.
  bool may_show_back(const Eigen::Vector3d& eye) const { return !closed() || body.contains(eye); }
};

struct SurfacePatches {
  std::vector<Patch> patches;
  std::vector<Chart> charts;
  std::vector<int> patch_of_triangle;                   ///< scene triangle index to patch
  std::vector<std::array<Eigen::Vector3d, 3>> corners;  ///< of each scene triangle, node frame
};

/// Deterministic; takes about 1 s for 200,000 triangles. Triangles are numbered node after node,
/// as in gl::SceneBuffers.
SurfacePatches find_surface_patches(const SceneModel& scene, const PatchOptions& options);

}  // namespace foresight
