// Marks pixels on the far side of a depth discontinuity, within the margin (thesis, case 3 in
// section 5.1.1): a small registration error would paint them with what stands in front.
//
//   near surface ____      q: nearer than the plane of p, extended to q
//                    |margin|
//                    |......p___________ far surface
//
// Discontinuity means: off the plane. 1/z is linear in the picture of a plane, so that a plane seen
// at a grazing angle is none.
#include "camera.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2DArray depth;
layout(binding = 1) uniform sampler2DArray blocks;
layout(binding = 0, r8) uniform writeonly image2DArray uncertain;
uniform ivec2 face_size;
uniform float margin;            // px
uniform float depth_tolerance;   // metres

float inverse_z(ivec2 at, int layer) {
  return texelFetch(depth, ivec3(clamp(at, ivec2(0), face_size - 1), layer), 0).r / kNear;
}

// True where the smoothness of a whole neighbourhood makes the test needless.
bool is_smooth(ivec3 tile, int reach) {
  ivec2 last = (face_size + 3) / 4 - 1;
  float far = 1e30, near = 0.0;
  for (int y = -reach; y < 2 + reach; ++y)
    for (int x = -reach; x < 2 + reach; ++x) {
      vec2 b = texelFetch(blocks, ivec3(clamp(tile.xy * 2 + ivec2(x, y), ivec2(0), last), tile.z), 0).xy;
      near = max(near, b.y);
      if (x >= 0 && x < 2 && y >= 0 && y < 2) far = min(far, abs(b.x));
    }
  return near == 0.0 || 1.0 / far - 1.0 / near < depth_tolerance;
}

// Slope of 1/z along `step` at p, from the side on which the surface bends less.
float slope(ivec2 p, ivec2 step, int layer, float center) {
  float a1 = inverse_z(p - step, layer), a2 = inverse_z(p - 2 * step, layer);
  float b1 = inverse_z(p + step, layer), b2 = inverse_z(p + 2 * step, layer);
  float bend_a = a1 > 0.0 && a2 > 0.0 ? abs(a2 - 2.0 * a1 + center) : 1e30;
  float bend_b = b1 > 0.0 && b2 > 0.0 ? abs(b2 - 2.0 * b1 + center) : 1e30;
  if (min(bend_a, bend_b) > 1e29) return 0.0;
  return bend_a < bend_b ? center - a1 : b1 - center;
}

bool is_uncertain(ivec2 p, int layer) {
  float center = inverse_z(p, layer);
  if (center <= 0.0) return false;
  vec2 gradient = vec2(slope(p, ivec2(1, 0), layer, center), slope(p, ivec2(0, 1), layer, center));
  int reach = int(ceil(margin));
  float limit = (margin + 0.5) * (margin + 0.5);
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach; x <= reach; ++x) {
      float near = inverse_z(p + ivec2(x, y), layer);
      float plane = center + dot(gradient, vec2(x, y));
      // 1/plane - 1/near > tolerance, without dividing; a plane beyond the horizon is behind all.
      bool off = near > plane && near - plane > depth_tolerance * near * max(plane, 0.0);
      if (off && float(x * x + y * y) <= limit) return true;
    }
  return false;
}

void main() {
  ivec3 at = ivec3(gl_GlobalInvocationID);
  if (margin <= 0.0 || is_smooth(ivec3(gl_WorkGroupID), (int(ceil(margin)) + 3) / 4)) {
    imageStore(uncertain, at, vec4(0.0));
    return;
  }
  imageStore(uncertain, at, vec4(is_uncertain(at.xy, at.z) ? 1.0 : 0.0));
}
