// The same surface with fewer triangles: CAD meshes of robots come with more than any camera can tell apart.
#pragma once

#include "scene/mesh.hpp"

namespace foresight {

/// Collapses edges, the flattest first, as long as the new vertex keeps within `tolerance` metres (> 0; root mean
/// square over their area) of the planes of all triangles that it stands for (Garland and Heckbert, "Surface
/// Simplification Using Quadric Error Metrics", 1997). No triangle turns over, borders stay nearly where they are, and
/// separate pieces stay apart. Same input, same result.
Mesh simplified(const Mesh& mesh, double tolerance);

}  // namespace foresight
