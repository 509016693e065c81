// Of each block of 16 x 16 pixels: the largest and the smallest inverse depth, 0 where there is no model.
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2DArray depth;
layout(binding = 0, rg32f) uniform writeonly image2D near_far;
uniform ivec2 size;  // px

void main() {
  ivec2 block = ivec2(gl_GlobalInvocationID.xy);
  ivec2 first = 16 * block, last = min(first + 15, size - 1);
  if (any(greaterThanEqual(first, size))) return;
  float most = 0.0, least = 1e30;
  for (int y = first.y; y <= last.y; ++y)
    for (int x = first.x; x <= last.x; ++x) {
      float q = texelFetch(depth, ivec3(x, y, 0), 0).r;
      most = max(most, q);
      least = min(least, q);
    }
  imageStore(near_far, block, vec4(most, least, 0.0, 0.0));
}
