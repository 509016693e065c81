// What each pixel of the target sees, found in the source: see depth_warp.hpp. A group for each tile of a list.
// Defines: SEARCHED: 1 where surfaces part within the tile's reach, 0 where there is one. MOVED: 1 where nodes have moved.
// DISTORTED: as in warp_rays.glsl. TELLS: 1 where depth and holes are asked for. KEEPS: 1 where what other sources have seen stays, unless this one has seen something nearer. MENDS: 1 where only holes
// are looked up, in layers of what lies behind edges.
layout(local_size_x = 8, local_size_y = 8) in;
#include "view_alpha.glsl"
#include "warp_rays.glsl"
layout(binding = 0) uniform sampler2D depth;    // 1/m, 0 where no model is
layout(binding = 1) uniform sampler2D picture;  // linear
layout(binding = 2) uniform sampler2D reach;    // of blocks: largest and smallest inverse depth around
layout(binding = 3) uniform usamplerBuffer tiles;
#if KEEPS
layout(binding = 0, rgba8) uniform image2D warped;
layout(binding = 2, r32f) uniform image2D warped_depth;
#else
layout(binding = 0, rgba8) uniform writeonly image2D warped;
layout(binding = 2, r32f) uniform writeonly image2D warped_depth;
#endif
#if KEEPS || MENDS
layout(binding = 1, r8) uniform image2D holes;
#else
layout(binding = 1, r8) uniform writeonly image2D holes;
#endif
#if MENDS
layout(std430, binding = 4) buffer Count { uint mended; };
#endif
#if !SEARCHED
layout(binding = 4) uniform samplerBuffer corners;  // of a tile: inverse target depths
#endif
#if MOVED
layout(binding = 4) uniform usampler2D nodes;
layout(binding = 5) uniform usamplerBuffer slot_of_node;  // 0: stands still; else where `moved` has it, + 1
layout(binding = 6) uniform samplerBuffer moved;          // kWords a node
uniform int moved_count;
const int kWords = 6;  // three rows, back, the node's rectangle in the target, its inverse depths
uint slot = 0u;        // of what is searched for
#endif
#if KEEPS
uniform int of_part;  // 1: where the source has no model, others may
#endif
const int kTilesFrom = 3;    // of the list: before them, the groups
const int kMostSteps = 32, kMostTries = 4;
const float kHit = 0.75;     // px: closer than that, the surface is the pixel's
const float kSmooth = 0.02;  // relative difference of depth beyond which two pixels are of two surfaces
const float kNone = 1e30;

// Below 0: something else stands there.
float depth_at(vec2 at) {
  ivec2 p = nearest_pixel(at);
  float q = texelFetch(depth, p, 0).r;
#if MENDS
  if (q == 0.0) return -1.0;  // nobody has looked there
#endif
#if MOVED
  q = texelFetch(slot_of_node, int(texelFetch(nodes, p, 0).r)).r == slot ? q : -1.0;
#endif
  return q;
}

vec2 in_texture(vec2 at) {
  return (at + 0.5) / vec2(source_size);
}

// Alpha tells classes, between which nothing lies.
vec4 classed(vec4 colour) {
  colour.a = colour.a > 0.75 ? kFromImage : colour.a > 0.375 ? kFromFill : colour.a > 0.125 ? kBare : 0.0;
  return colour;
}

bool inside(vec2 at) {
  return all(greaterThanEqual(at, vec2(-0.5))) && all(lessThan(at, vec2(source_size) - 0.5));
}

void put(ivec2 pixel, vec2 at, vec4 colour, bool found, float w) {
  bool is_inside = inside(at);
#if KEEPS
  if (!is_inside || (of_part != 0 && w <= 0.0)) return;
  float before = imageLoad(holes, pixel).r;
  if (before < 0.9 && !found) return;
  if (before < 0.1 && w <= imageLoad(warped_depth, pixel).r) return;
#endif
#if MENDS
  if (!is_inside || !found) return;
  atomicAdd(mended, 1u);
#endif
  imageStore(warped, pixel, vec4(colour.rgb, is_inside ? colour.a : 0.0));
#if TELLS
  imageStore(holes, pixel, vec4(is_inside ? (found ? 0.0 : 128.0 / 255.0) : 1.0));
  imageStore(warped_depth, pixel, vec4(w));
#endif
}

// Where the target's lens sees nothing.
void put_nothing(ivec2 pixel) {
  imageStore(warped, pixel, vec4(0.0));
#if TELLS
  imageStore(holes, pixel, vec4(0.0));
  imageStore(warped_depth, pixel, vec4(0.0));
#endif
}

#if SEARCHED
float found = -1.0, background = kNone;  // inverse target depths; found: below 0 where nothing was
vec2 found_at, background_at;

void search(float nearest, float farthest) {
  int steps = clamp(int(ceil(length(place(nearest) - place(farthest)))), 1, kMostSteps);
  int i = 0;
  for (int tries = 0; tries < kMostTries && i <= steps; ++tries) {
    float here = 0.0;
    for (; i <= steps; ++i) {
      float w = mix(nearest, farthest, float(i) / float(steps));
      vec2 at = place(w);
      float q = depth_at(at);
      here = surface(at, max(q, 0.0));
#if MOVED
      if (q < 0.0) here = slot == 0u ? kNone : -1.0;
      if (slot == 0u && here < background) {
#else
      if (here < background) {
#endif
        background = here;
        background_at = at;
      }
      if (q >= 0.0 && (here >= w || i == steps)) break;  // before that, the ray is still in front of it
    }
    if (i > steps) return;
    // Two steps towards where the ray meets this very surface.
    vec2 closer = place(here);
    float q = depth_at(closer);
    closer = place(surface(closer, max(q, 0.0)));
    float again_q = depth_at(closer);
    float again = surface(closer, max(again_q, 0.0));
    if (q >= 0.0 && again_q >= 0.0 && length(place(again) - closer) < kHit) {
      found = again;
      found_at = place(again);
      return;
    }
    ++i;
  }
}

// Between its four neighbours where they are of one surface; else the nearest one's.
vec4 colour_at(vec2 at) {
  vec4 q = textureGather(depth, in_texture(at));
  float most = max(max(q.x, q.y), max(q.z, q.w)), least = min(min(q.x, q.y), min(q.z, q.w));
  return textureLod(picture, in_texture(most - least <= kSmooth * most ? at : floor(at + 0.5)), 0.0);
}
#endif

#if MOVED
// Where a part stood that has gone: the farthest of what is seen around it.
void look_around(vec2 from) {
  for (float ring = 2.0; ring <= 64.0 && background == kNone; ring *= 2.0)
    for (int i = 0; i < 8; ++i) {
      float turn = float(i) * 0.7853982;
      vec2 at = from + ring * vec2(cos(turn), sin(turn));
      float q = depth_at(at);
      float here = surface(at, max(q, 0.0));
      if (q < 0.0 || here >= background) continue;
      background = here;
      background_at = at;
    }
}

void search_moved(vec2 pixel) {
  for (int i = 0; i < moved_count; ++i) {
    vec4 rectangle = texelFetch(moved, kWords * i + 4);
    if (any(lessThan(pixel, rectangle.xy)) || any(greaterThan(pixel, rectangle.zw))) continue;
    float before = found;
    vec2 before_at = found_at;
    vec4 depths = texelFetch(moved, kWords * i + 5);
    aim(ray_of(pixel), texelFetch(moved, kWords * i), texelFetch(moved, kWords * i + 1), texelFetch(moved, kWords * i + 2),
        texelFetch(moved, kWords * i + 3));
    slot = uint(i) + 1u;
    found = -1.0;
    search(depths.x, depths.y);
    if (found > before) continue;
    found = before;
    found_at = before_at;
  }
}
#endif

void main() {
  uint tile = texelFetch(tiles, kTilesFrom + int(gl_WorkGroupID.x)).r;
  ivec2 pixel = 8 * ivec2(tile & 0xffffu, tile >> 16) + ivec2(gl_LocalInvocationID.xy);
  if (any(greaterThanEqual(pixel, target_size))) return;
#if DISTORTED
  if (!sees(vec2(pixel))) {
    put_nothing(pixel);
    return;
  }
#endif
#if MENDS
  float hole = imageLoad(holes, pixel).r;
  if (hole < 0.25 || hole > 0.75) return;
#endif
  aim(ray_of(vec2(pixel)), r0, r1, r2, back);
#if SEARCHED
  vec2 far_away = place(0.0);
  vec2 around = texelFetch(reach, nearest_pixel(far_away) / 8, 0).rg;
  float farthest = surface(far_away, around.g) * 0.98;
  found_at = far_away;
  background_at = place(farthest);
  search(surface(far_away, around.r) * 1.02, farthest);
#if MOVED && !MENDS
  if (found < 0.0 && background == kNone) look_around(far_away);
  search_moved(vec2(pixel));
#endif
  bool is_found = found >= 0.0;
  vec2 at = is_found ? found_at : background_at;
  put(pixel, at, classed(colour_at(at)), is_found, is_found ? found : background == kNone ? 0.0 : background);
#else
  // A plane's inverse depth is linear in the picture.
  vec4 w4 = texelFetch(corners, int(gl_WorkGroupID.x));
  vec2 t = (vec2(gl_LocalInvocationID.xy) + 0.5) / 8.0;
  float w = mix(mix(w4.x, w4.y, t.x), mix(w4.z, w4.w, t.x), t.y);
  vec2 at = place(w);
  put(pixel, at, classed(textureLod(picture, in_texture(at), 0.0)), true, w);
#endif
}
