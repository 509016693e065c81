// Largest and smallest inverse depth of each block and those beside it, along rows or along columns, as far as surfaces
// can have moved.
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2D blocks;
layout(binding = 0, rgba32f) uniform writeonly image2D reach;
uniform ivec2 size, way;  // blocks
uniform int radius;       // blocks

void main() {
  ivec2 block = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(block, size))) return;
  vec2 both = vec2(0.0, 1e30);
  for (int i = -radius; i <= radius; ++i) {
    vec2 one = texelFetch(blocks, clamp(block + i * way, ivec2(0), size - 1), 0).rg;
    both = vec2(max(both.r, one.r), min(both.g, one.g));
  }
  imageStore(reach, block, vec4(both, 0.0, 0.0));
}
