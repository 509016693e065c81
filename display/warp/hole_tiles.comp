// Which tiles of 8 x 8 px have holes in them.
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2D holes;  // as DepthWarp::holes()
layout(binding = 0, std430) buffer List { uint groups[3]; uint list[]; };
uniform ivec2 tiles;

bool is_hole(float value) {
  return value > 0.25 && value < 0.75;
}

void main() {
  ivec2 tile = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(tile, tiles))) return;
  vec2 size = vec2(textureSize(holes, 0));
  for (int y = 0; y < 8; y += 2)
    for (int x = 0; x < 8; x += 2) {
      vec4 four = textureGather(holes, vec2(8 * tile + ivec2(x, y) + 1) / size);
      if (!is_hole(four.x) && !is_hole(four.y) && !is_hole(four.z) && !is_hole(four.w)) continue;
      list[atomicAdd(groups[0], 1u)] = uint(tile.x) | uint(tile.y) << 16;
      return;
    }
}
