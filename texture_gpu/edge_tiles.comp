// Lists the 8x8 tiles of a face in which the exact test for uncertain edges must run: those where
// the nearest surface around lies in front of the farthest within by more than the tolerance.
#include "camera.glsl"
#include "work_list.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 1) uniform sampler2DArray blocks;
uniform ivec2 face_size;
uniform int reach;               // blocks
uniform float depth_tolerance;   // metres

void main() {
  ivec3 tile = ivec3(gl_GlobalInvocationID);
  ivec2 last = (face_size + 3) / 4 - 1;
  float far = 1e30, near = 0.0;
  for (int y = -reach; y < 2 + reach; ++y)
    for (int x = -reach; x < 2 + reach; ++x) {
      vec2 b = texelFetch(blocks, ivec3(clamp(tile.xy * 2 + ivec2(x, y), ivec2(0), last), tile.z), 0).xy;
      near = max(near, b.y);
      if (x >= 0 && x < 2 && y >= 0 && y < 2) far = min(far, abs(b.x));
    }
  bool inside = all(lessThan(tile.xy * 8, face_size));
  // far stays huge where the tile shows no model: nothing there to be uncertain about.
  if (inside && far < 1e29 && near > 0.0 && 1.0 / far - 1.0 / near > depth_tolerance)
    append_work(uint(tile.x) | uint(tile.y) << 12 | uint(tile.z) << 24);
}
