// Lists the pixels on the near side of depth discontinuities: those at which a surface ends.
#include "camera.glsl"
#include "depth_slope.glsl"
#include "work_item.glsl"
#include "work_list.glsl"
layout(local_size_x = 8, local_size_y = 8) in;

void main() {
  uint tile;
  if (!next_work(tile)) return;
  ivec3 at = ivec3(8 * ivec2(tile & 0xfffu, (tile >> 12) & 0xfffu) + ivec2(gl_LocalInvocationID.xy), int(tile >> 24));
  float center = inverse_z(at.xy, at.z);
  if (any(ends_around(at.xy, center, at.z))) append_work(uint(at.x) | uint(at.y) << 14 | uint(at.z) << 28);
}
