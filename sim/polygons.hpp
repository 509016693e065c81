// Triangles of one flat, convex face are one polygon, however the face was cut.
#pragma once

#include <vector>

#include "sim/lab.hpp"

namespace foresight::sim {

struct Polygons {
  std::vector<int> of_facet;  ///< polygon of each facet, numbered through all parts in order
  int count = 0;
};

/// Joins triangles that share an edge and a plane where the face that they make together is
/// convex; elsewhere only the two halves of a quadrangle.
Polygons polygons_of(const Lab& lab);

}  // namespace foresight::sim
