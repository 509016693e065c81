// Largest and smallest inverse depth of each block and those beside it, and whether surfaces part in any of them: along
// rows or along columns, as far as surfaces can have moved.
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2D blocks;
layout(binding = 0, rgba32f) uniform writeonly image2D around;
uniform ivec2 size, way;  // blocks
uniform int radius;       // blocks
uniform int of_part;      // 1: blocks without a model do not count

void main() {
  ivec2 block = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(block, size))) return;
  vec3 all = vec3(0.0, 1e30, 0.0);
  for (int i = -radius; i <= radius; ++i) {
    vec3 one = texelFetch(blocks, clamp(block + i * way, ivec2(0), size - 1), 0).rgb;
    if (of_part == 0 || one.r > 0.0) all.g = min(all.g, one.g);
    all.rb = max(all.rb, one.rb);
  }
  imageStore(around, block, vec4(all.r, min(all.g, all.r), all.b, 0.0));
}
