// view.glsl for the pixels of some rows, or for those of a list. Defines: there.
layout(local_size_x = 64) in;
#if LISTED
#define WORK_UNIT 5
#define INVOCATIONS_PER_ITEM 1
#include "work_item.glsl"
#else
uniform ivec2 rows;  // first, and beyond the last
#endif
#include "view.glsl"

void main() {
#if LISTED
  uint item;
  if (!next_work(item)) return;
  ivec2 pixel = ivec2(item & 0xffffu, item >> 16);
#else
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, rows.x);
  if (pixel.x >= int(camera.size.x) || pixel.y >= rows.y) return;
#endif
  draw_pixel(pixel);
}
