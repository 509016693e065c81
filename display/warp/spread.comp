// The same of each block and its eight neighbours.
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2D near_far;
layout(binding = 0, rg32f) uniform writeonly image2D reach;
uniform ivec2 size;  // blocks

void main() {
  ivec2 block = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(block, size))) return;
  vec2 both = vec2(0.0, 1e30);
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      vec2 one = texelFetch(near_far, clamp(block + ivec2(x, y), ivec2(0), size - 1), 0).rg;
      both = vec2(max(both.r, one.r), min(both.g, one.g));
    }
  imageStore(reach, block, vec4(both, 0.0, 0.0));
}
