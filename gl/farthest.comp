// Of tiles of 8 x 8: the least near / z, which is that of the farthest surface, or 0 where no model is. Level 0: of
// pixels; level 1: of the tiles of level 0.
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2DArray depth;
layout(binding = 1) uniform sampler2D tiles;
layout(binding = 0, r32f) uniform writeonly image2D farthest;
uniform int level, layer;

float value(ivec2 at) {
  return level == 0 ? texelFetch(depth, ivec3(at, layer), 0).r : texelFetch(tiles, at, 0).r;
}

void main() {
  ivec2 tile = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(tile, imageSize(farthest)))) return;
  ivec2 size = level == 0 ? textureSize(depth, 0).xy : textureSize(tiles, 0);
  ivec2 first = 8 * tile, last = min(first + 7, size - 1);
  float least = 1.0;
  for (int y = first.y; y <= last.y; ++y)
    for (int x = first.x; x <= last.x; ++x) least = min(least, value(ivec2(x, y)));
  imageStore(farthest, tile, vec4(least));
}
