// Finely divided surfaces: what a scanner or a CAD program makes of turned, bent and cast things.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <random>

#include "scene/mesh.hpp"

namespace foresight::sim {

/// A surface over the unit square, u along and v across it.
using WovenSurface = std::function<Eigen::Vector3d(double u, double v)>;

struct Weave {
  int along = 8, across = 8;  ///< quadrangles; at least 1, 3 where closed
  bool closed_along = false, closed_across = false;
};

/// Two triangles for each quadrangle, welded; those without area (at poles) are left out.
Mesh woven(const Weave& weave, const WovenSurface& surface);

/// A turned solid of about so many triangles, at most `reach` m around the z axis, its foot at the origin.
Mesh turned_solid(std::size_t triangles, double reach, std::mt19937& random);
/// A tube of about so many triangles around a way (m).
Mesh tube(std::size_t triangles, double radius, const std::function<Eigen::Vector3d(double u)>& way);
/// A toothed wheel of about so many triangles around the z axis.
Mesh toothed_wheel(std::size_t triangles, double radius, double width, int teeth);
/// A cast block with rounded edges and dents, its foot at the origin.
Mesh cast_block(std::size_t triangles, const Eigen::Vector3d& size, std::mt19937& random);

}  // namespace foresight::sim
