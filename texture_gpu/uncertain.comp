// Marks pixels on the far side of a depth discontinuity, within the margin (thesis, case 3 in
// section 5.1.1): a small registration error would paint them with what stands in front.
//
//   near surface ___q      q: of near_edges.comp; its surface is thought to go on
//                    |margin|
//                    |..p.p.p_______ far surface: behind it by more than the tolerance
//
// One invocation a pixel q.
#define ITEMS_PER_GROUP 64
#include "camera.glsl"
#include "depth_slope.glsl"
#include "work_item.glsl"
layout(local_size_x = 64) in;
layout(binding = 0, r8) uniform writeonly image2DArray uncertain;
uniform float margin;           // px
uniform float depth_tolerance;  // metres

// 0 where the surface bends too much on both sides to have a plane: it is a few pixels wide.
float slope_of_plane(ivec2 q, ivec2 step, int layer, float center) {
  float s = slope(q, step, layer, center);
  float bend = min(abs(inverse_z(q + 2 * step, layer) - center - 2.0 * s), abs(inverse_z(q - 2 * step, layer) - center + 2.0 * s));
  return bend > depth_tolerance * center * center ? 0.0 : s;
}

void main() {
  uint item;
  if (!next_work(item)) return;
  ivec2 q = ivec2(item & 0x3fffu, (item >> 14) & 0x3fffu);
  int layer = int(item >> 28);
  float center = inverse_z(q, layer);
  vec2 gradient = vec2(slope_of_plane(q, ivec2(1, 0), layer, center), slope_of_plane(q, ivec2(0, 1), layer, center));
  int reach = int(ceil(margin));
  float limit = (margin + 0.5) * (margin + 0.5);
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach; x <= reach; ++x) {
      vec2 offset = vec2(x, y);
      float far = inverse_z(q + ivec2(x, y), layer);
      // A near surface that comes closer away from its edge must not count as behind it.
      float near = min(center, center + dot(gradient, offset));
      bool behind = far > 0.0 && near - far > depth_tolerance * near * far;
      if (behind && dot(offset, offset) <= limit) imageStore(uncertain, ivec3(q + ivec2(x, y), layer), vec4(1.0));
    }
}
