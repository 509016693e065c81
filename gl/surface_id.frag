// Which triangle is seen: its index in the scene plus one; 0 is left where there is no model.
// Define: PART 1 where only a part of the view is drawn: see raster_pass.hpp.
uniform uint first_triangle;
layout(location = 0) out uint surface;
#if PART
#include "view_part.glsl"
#endif

void main() {
#if PART
  if (is_left_out()) discard;
#endif
  surface = first_triangle + uint(gl_PrimitiveID) + 1u;
}
