// Nearest and farthest model depth of each 4x4 block of a face, as 1/z. Preselects where the exact
// test for uncertain edges must run, and hides pages that lie behind everything.
#include "camera.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2DArray depth;
layout(binding = 0, rg32f) uniform writeonly image2DArray blocks;  // x: least 1/z over pixels with model, y: largest
uniform ivec2 face_size;

void main() {
  ivec3 block = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(block.xy * 4, face_size))) return;
  float low = 1e30, high = 0.0;
  bool hole = false;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) {
      ivec2 at = min(block.xy * 4 + ivec2(x, y), face_size - 1);
      float d = texelFetch(depth, ivec3(at, block.z), 0).r;
      low = d > 0.0 ? min(low, d) : low;
      high = max(high, d);
      hole = hole || d == 0.0;
    }
  // A negative low tells that the block also shows no model: it hides nothing behind it.
  imageStore(blocks, block, vec4((hole ? -low : low) / kNear, high / kNear, 0.0, 0.0));
}
