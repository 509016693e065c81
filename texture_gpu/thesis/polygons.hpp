// The thesis' scene: convex planar polygons, each with a texture of its own.
#pragma once

#include "texture_gpu/polygons.hpp"

namespace foresight::thesis {

using foresight::find_polygons;
using foresight::Polygon;

}  // namespace foresight::thesis
