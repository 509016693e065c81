// Lists the pixels on the near side of depth discontinuities: those in front of the plane of the
// surface next to them.
//
//   q ____            r, r2: the surface beyond; its plane, extended to q, is behind q by more than
//         |           the tolerance
//         |  r r2
//         |__.__.___
//
// Off the plane, not just nearer: 1/z is linear in the picture of a plane, so that a plane seen at
// a grazing angle has no discontinuity, and a crease has none.
#include "camera.glsl"
#include "depth_slope.glsl"
#include "work_item.glsl"
#include "work_list.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
uniform float depth_tolerance;  // metres

bool in_front(float near, float far) {  // 1/far - 1/near > tolerance; a plane beyond its horizon is behind all
  far = max(far, 0.0);
  return near - far > depth_tolerance * near * far;
}

// Is `q` in front of what lies beyond it along `step`?
bool ends(ivec2 q, float center, ivec2 step, int layer) {
  float r = inverse_z(q + step, layer), r2 = inverse_z(q + 2 * step, layer);
  if (r <= 0.0 || r >= center) return false;
  if (r2 > 0.0) return in_front(center, 2.0 * r - r2);
  // Nothing tells the slope beyond: the near surface's own goes on.
  float before = inverse_z(q - step, layer);
  return in_front(before > 0.0 ? 2.0 * center - before : center, r);
}

void main() {
  uint tile;
  if (!next_work(tile)) return;
  ivec3 at = ivec3(8 * ivec2(tile & 0xfffu, (tile >> 12) & 0xfffu) + ivec2(gl_LocalInvocationID.xy), int(tile >> 24));
  float center = inverse_z(at.xy, at.z);
  if (center > 0.0 && (ends(at.xy, center, ivec2(1, 0), at.z) || ends(at.xy, center, ivec2(-1, 0), at.z) ||
                       ends(at.xy, center, ivec2(0, 1), at.z) || ends(at.xy, center, ivec2(0, -1), at.z)))
    append_work(uint(at.x) | uint(at.y) << 14 | uint(at.z) << 28);
}
