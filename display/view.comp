// view.glsl for the pixels of some rows, or for those of a list. Defines: there.
#if LISTED
#define WORK_UNIT 5
#define ITEMS_PER_GROUP 64
#include "work_item.glsl"
layout(local_size_x = 64) in;
#else
layout(local_size_x = 64) in;
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
