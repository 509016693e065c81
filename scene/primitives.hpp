// Meshes of the solids that a URDF can name, centred at the origin. Sizes in metres, positive.
#pragma once

#include <Eigen/Core>

#include "scene/mesh.hpp"

namespace foresight {

Mesh make_box(const Eigen::Vector3d& size);

/// Around z, with closed ends; vertices lie on the surface, 32 around.
Mesh make_cylinder(double radius, double length);

/// Poles on z; vertices lie on the surface, 32 around and 16 from pole to pole.
Mesh make_sphere(double radius);

}  // namespace foresight
