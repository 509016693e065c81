// Lists the pixels of some rows at which a model is, of a view whose pixels are those of its only face. Groups as in view.comp.
#include "work_list.glsl"
layout(local_size_x = 64) in;
layout(binding = 1) uniform usampler2DArray surfaces;  // triangle + 1
uniform ivec2 rows;                                    // first, and beyond the last

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, rows.x);
  if (pixel.x >= textureSize(surfaces, 0).x || pixel.y >= rows.y) return;
  if (texelFetch(surfaces, ivec3(pixel, 0), 0).r != 0u) append_work(uint(pixel.x) | uint(pixel.y) << 16);
}
