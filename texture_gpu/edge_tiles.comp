// Lists the 8x8 tiles of a face that may hold the near side of a depth discontinuity: all but those
// that lie on one plane with nothing behind it around them. A plane is linear in 1/z, so the
// extremes of each 4x4 block tell whether it fits. Half of the tolerance is left for the slopes
// that the exact test estimates pixel by pixel.
#include "camera.glsl"
#include "depth_slope.glsl"
#include "work_list.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 1) uniform sampler2DArray blocks;

void main() {
  ivec3 tile = ivec3(gl_GlobalInvocationID);
  ivec2 last = (face_size + 3) / 4 - 1;
  ivec2 middle = min(tile.xy * 8 + 4, face_size - 1);
  float center = inverse_z(middle, tile.z);
  vec2 gradient = vec2(slope(middle, ivec2(1, 0), tile.z, center), slope(middle, ivec2(0, 1), tile.z, center));
  float spread = 1.5 * (abs(gradient.x) + abs(gradient.y));  // within a block, from its centre
  bool smooth_around = true, has_model = false;
  for (int y = -1; y < 3; ++y)
    for (int x = -1; x < 3; ++x) {
      ivec2 block = clamp(tile.xy * 2 + ivec2(x, y), ivec2(0), last);
      vec2 b = texelFetch(blocks, ivec3(block, tile.z), 0).xy;
      float plane = center + dot(gradient, vec2(block * 4) + 1.5 - vec2(middle));
      float slack = 0.5 * depth_tolerance * b.y * max(plane, 0.0);
      bool own = x >= 0 && x < 2 && y >= 0 && y < 2;
      smooth_around = smooth_around && (!own || b.y - (plane + spread) <= slack) && (plane - spread - abs(b.x) <= slack || b.y == 0.0);
      has_model = has_model || (own && b.y > 0.0 && abs(b.x) < 1e29);  // and the image shows it
    }
  bool inside = all(lessThan(tile.xy * 8, face_size));
  if (inside && has_model && !(smooth_around && center > 0.0))
    append_work(uint(tile.x) | uint(tile.y) << 12 | uint(tile.z) << 24);
}
