// Marks the 4x4 tiles of a view's faces in which depth may have a step: those whose depth is not that of planes.
#include "camera.glsl"
#include "depth_slope.glsl"
layout(local_size_x = 32, local_size_y = 2) in;
layout(binding = 1, r8) uniform writeonly image2DArray steps;
const float kSuspicious = 0.45;  // of the tolerance: a little less than silhouettes.comp asks for

// Pixels of a row: the four that are the tile's, and what is left and right of each.
struct Row {
  vec4 left, here, right;
};

// Depths of the 2x2 pixels around a corner: below left, below right, above right, above left.
vec4 around(vec2 corner, int layer) {
  return textureGather(depth, vec3(corner / vec2(face_size), layer));
}

// The rows above and below a corner, the leftmost of three.
void find_rows(vec2 corner, int layer, out Row above, out Row below) {
  vec4 a = around(corner, layer), b = around(corner + vec2(2.0, 0.0), layer), c = around(corner + vec2(4.0, 0.0), layer);
  above = Row(vec4(a.wz, b.wz), vec4(a.z, b.wz, c.w), vec4(b.wz, c.wz));
  below = Row(vec4(a.xy, b.xy), vec4(a.y, b.xy, c.x), vec4(b.xy, c.xy));
}

// 1/z is linear in the picture of a plane: what is on either side of a pixel tells its own, but for a step.
bool has_step(vec4 above, Row row, vec4 below) {
  vec4 bent = max(abs(row.left + row.right - 2.0 * row.here), abs(above + below - 2.0 * row.here));
  return any(greaterThan(bent, kSuspicious * depth_tolerance / kNear * row.here * row.here));
}

void main() {
  ivec3 tile = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(4 * tile.xy, face_size))) return;
  vec2 first = vec2(4 * tile.xy);
  Row a, b, c, d, e, f;
  find_rows(first, tile.z, a, b);
  find_rows(first + vec2(0.0, 2.0), tile.z, c, d);
  find_rows(first + vec2(0.0, 4.0), tile.z, e, f);
  bool found = has_step(a.here, b, c.here) || has_step(b.here, c, d.here) || has_step(c.here, d, e.here) || has_step(d.here, e, f.here);
  imageStore(steps, tile, vec4(found));
}
