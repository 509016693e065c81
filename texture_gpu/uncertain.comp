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
#include "depth_slope.glsl"
#include "work_item.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0, r8) uniform writeonly image2DArray uncertain;
uniform float margin;            // px
uniform float depth_tolerance;   // metres

bool is_uncertain(ivec2 p, int layer) {
  float center = inverse_z(p, layer);
  if (center <= 0.0) return false;
  vec2 gradient = vec2(slope(p, ivec2(1, 0), layer, center), slope(p, ivec2(0, 1), layer, center));
  int reach = int(ceil(margin));
  float limit = (margin + 0.5) * (margin + 0.5);
  vec2 half_face = 0.5 * vec2(face_size - 1), from_middle = vec2(p) - half_face;
  bool found = false;
  // Four pixels at a time; the last column and row of the quads may reach beyond the margin.
  for (int y = -reach; y <= reach; y += 2)
    for (int x = -reach; x <= reach; x += 2) {
      vec2 corner = (vec2(p) + vec2(x, y) + 1.0) / vec2(face_size);
      vec4 near = textureGather(depth, vec3(corner, float(layer))) / kNear;  // (0,1) (1,1) (1,0) (0,0)
      vec4 dx = float(x) + vec4(0.0, 1.0, 1.0, 0.0), dy = float(y) + vec4(1.0, 1.0, 0.0, 0.0);
      // 1/plane - 1/near > tolerance, without dividing; a plane beyond the horizon is behind all
      // that there is.
      vec4 plane = max(center + gradient.x * dx + gradient.y * dy, 0.0);
      vec4 excess = near - plane - depth_tolerance * near * plane;
      // Beyond the margin, or beyond the face: the border's depth, repeated there, is off the plane.
      vec4 beyond = max(abs(dx + from_middle.x) - half_face.x, abs(dy + from_middle.y) - half_face.y);
      vec4 outside = max(dx * dx + dy * dy - limit, beyond);
      found = found || any(bvec4(ivec4(greaterThan(excess, vec4(0.0))) * ivec4(lessThanEqual(outside, vec4(0.0)))));
    }
  return found;
}

void main() {
  uint tile;
  if (!next_work(tile)) return;
  ivec3 at = ivec3(8 * ivec2(tile & 0xfffu, (tile >> 12) & 0xfffu) + ivec2(gl_LocalInvocationID.xy), int(tile >> 24));
  imageStore(uncertain, at, vec4(is_uncertain(at.xy, at.z) ? 1.0 : 0.0));
}
