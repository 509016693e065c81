// Which tiles of 8 x 8 target pixels see one surface only, whatever their rays meet; which are to be searched; and in
// which of these a node stands, or stood, that has moved.
layout(local_size_x = 8, local_size_y = 8) in;
#include "warp_rays.glsl"
layout(binding = 0) uniform sampler2D blocks;  // of 8 x 8 px
layout(binding = 1) uniform sampler2D reach;   // the same of those around
layout(binding = 0, std430) buffer Smooth { uint smooth_groups[3]; uint smooth_tiles[]; };
layout(binding = 1, std430) buffer Searched { uint searched_groups[3]; uint searched_tiles[]; };
layout(binding = 2, std430) buffer WithMoved { uint moved_groups[3]; uint moved_tiles[]; };
layout(binding = 3, std430) writeonly buffer Corners { vec4 corners[]; };  // inverse target depths of tiles of one surface
layout(binding = 3) uniform sampler2D depth;     // 1/m
layout(binding = 2) uniform samplerBuffer moved;  // as in depth_warp.comp
uniform ivec2 tiles;
uniform int moved_count, keeps, of_part;
const int kWords = 6;
const ivec2 kMostBlocks = ivec2(6);

void main() {
  ivec2 tile = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(tile, tiles))) return;
  ivec2 high = (source_size - 1) / 8;
  vec2 low = vec2(1e9), most = vec2(-1e9);
  vec4 depths = vec4(0.0);
  bool is_whole = true;
  float any_model = 0.0;
  for (int corner = 0; corner < 4; ++corner) {
    vec2 at_corner = vec2(8 * tile) - 0.5 + 8.0 * vec2(corner & 1, corner >> 1);
    is_whole = is_whole && sees(at_corner);
    aim(ray_of(at_corner), r0, r1, r2, back);
    vec2 far_away = place(0.0);
    vec2 both = texelFetch(reach, nearest_pixel(far_away) / 8, 0).rg;
    any_model = max(any_model, both.r);
    float nearest = surface(far_away, both.r), farthest = surface(far_away, both.g);
    vec2 a = place(nearest * 1.02), b = place(farthest * 0.98);
    low = min(low, min(a, b));
    most = max(most, max(a, b));
    float w = 0.5 * (nearest + farthest);  // where there is one surface, the ray meets it
    for (int i = 0; i < 3; ++i) {
      vec2 at = place(w);
      w = surface(at, texelFetch(depth, nearest_pixel(at), 0).r);
    }
    depths[corner] = w;
  }
  if (of_part != 0 && any_model == 0.0) return;
  if (keeps != 0 && is_whole && (any(lessThan(most, vec2(-1.0))) || any(greaterThan(low, vec2(source_size))))) return;
  ivec2 first = clamp(ivec2(floor(low - 1.0)) >> 3, ivec2(0), high), last = clamp(ivec2(ceil(most + 1.0)) >> 3, ivec2(0), high);
  bool parts = !is_whole || any(greaterThan(last - first, kMostBlocks));
  last = min(last, first + kMostBlocks);
  for (int y = first.y; y <= last.y; ++y)
    for (int x = first.x; x <= last.x; ++x) parts = parts || texelFetch(blocks, ivec2(x, y), 0).b > 0.0;
  bool moves = false;
  for (int i = 0; i < moved_count; ++i) {
    vec4 rectangle = texelFetch(moved, kWords * i + 4);
    moves = moves || all(lessThanEqual(rectangle.xy, vec2(8 * tile + 8))) && all(greaterThanEqual(rectangle.zw, vec2(8 * tile)));
  }
  uint item = uint(tile.x) | uint(tile.y) << 16;
  if (moves) {
    moved_tiles[atomicAdd(moved_groups[0], 1u)] = item;
  } else if (parts) {
    searched_tiles[atomicAdd(searched_groups[0], 1u)] = item;
  } else {
    uint index = atomicAdd(smooth_groups[0], 1u);
    smooth_tiles[index] = item;
    corners[index] = depths;
  }
}
