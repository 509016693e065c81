// Of each block of 8 x 8 pixels: the largest and the smallest inverse depth, 0 where no model is; and whether
// surfaces part in it or at its border to the next blocks. Where the view shows parts only, pixels without a model do not
// count.
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2D depth;  // 1/m
layout(binding = 0, rgba32f) uniform writeonly image2D blocks;
uniform ivec2 size;  // px
uniform int of_part;
const float kSmooth = 0.02;  // as in depth_warp.comp

bool part(float a, float b) {
  return abs(a - b) > kSmooth * max(a, b);
}

void main() {
  ivec2 block = ivec2(gl_GlobalInvocationID.xy);
  ivec2 first = 8 * block, last = min(first + 7, size - 1);
  if (any(greaterThanEqual(first, size))) return;
  float most = 0.0, least = 1e30;
  bool parts = false;
  for (int y = first.y; y <= last.y; ++y) {
    float q = texelFetch(depth, ivec2(first.x, y), 0).r;
    for (int x = first.x; x <= last.x; ++x) {
      most = max(most, q);
      if (of_part == 0 || q > 0.0) least = min(least, q);
      float right = texelFetch(depth, ivec2(min(x + 1, size.x - 1), y), 0).r;
      parts = parts || part(q, right) || part(q, texelFetch(depth, ivec2(x, min(y + 1, size.y - 1)), 0).r);
      q = right;
    }
  }
  imageStore(blocks, block, vec4(most, min(least, most), parts ? 1.0 : 0.0, 0.0));
}
