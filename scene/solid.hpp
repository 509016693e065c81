// Whether a mesh is the surface of solid bodies.
#pragma once

#include "scene/mesh.hpp"

namespace foresight {

/// True where each edge is run through once in each direction, and each part of the mesh that hangs together encloses a
/// positive volume: from outside, the front of a triangle is nearest along any ray. False for a body with a cavity.
bool is_solid(const Mesh& mesh);

}  // namespace foresight
