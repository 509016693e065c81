// Which tiles hold points that camera 1 saw and camera 0 does not show as well: hidden there, out of its image, closer to
// its rim, or clearly coarser. One invocation a tile. Two steps, as most tiles are shown well:
//
//   STEP 0: camera 0 alone, four points a tile. What stands before its plane there, up to a few pixels beside, the nearest
//           surfaces of the blocks around tell. Says more often than not that a tile may be missed.
//   STEP 1: of those tiles, 4x4 points, and both cameras. Also tells where camera 0 shows none of them: camera 1 of the
//           next question will not have, either.
#include "camera.glsl"
#include "seen.glsl"
#include "atlas.glsl"
layout(local_size_x = 64) in;
layout(binding = 7) uniform samplerBuffer geometry;  // per page and camera four texels (ChartAtlas::write_page_geometry)
layout(binding = 9) uniform usampler2DArray heights;
layout(binding = 10) uniform usamplerBuffer tiles;  // page << 2 | tile
layout(binding = 11) uniform sampler2DArray blocks0;  // of camera 0 (blocks.comp)
layout(binding = 0, std430) writeonly buffer Answers { uint answers[]; };  // 1 missed, 3 clearly coarser; 4 hidden
uniform int first_group, tile_count;
uniform float worse;  // a share of the other camera's resolution below which this one's is clearly coarser

const float kRim = 6.0;  // px, as in view.glsl: towards its rim the image gives way to what the textures hold
const float kLessSeen = 0.1;
const float kStandsBefore = 0.25;  // share of the tolerance

// A tile in a camera's frame.
struct Tile {
  vec3 first, right, down, height;  // texel (0, 0) at raw height 1, and its steps
};

Tile tile_of(int page, int c, vec2 first) {
  int at = 4 * (2 * page + c);
  vec3 corner = texelFetch(geometry, at).xyz, right = texelFetch(geometry, at + 1).xyz,
       down = texelFetch(geometry, at + 2).xyz;
  return Tile(corner + first.x * right + first.y * down, right, down, texelFetch(geometry, at + 3).xyz);
}

// As in extract.comp: raw heights of texels on the surface begin at 1, or above with the bit that marks the chart's own.
vec3 point(Tile t, vec2 at, uint raw) {
  return t.first + at.x * t.right + at.y * t.down + (float(raw & 0x7fffu) - 1.0) * t.height;
}

// 0 at the image's rim, 1 well inside.
float within(int c, vec2 pixel) {
  vec2 inside = min(pixel, cameras[c].size.xy - 1.0 - pixel);
  return clamp(min(inside.x, inside.y) / kRim, 0.0, 1.0);
}

// How far the view relies on what camera `c` shows of `p`.
float shown(int c, vec3 p) {
  vec2 pixel;
  return is_seen(c, p, pixel) ? within(c, pixel) : 0.0;
}

// Nothing may stand before `p` in camera 0, nor within some pixels of it: what the four blocks around show is no nearer
// than the plane through `p` across `normal` (of any length), whose 1/z is linear in the picture.
bool is_clear(vec3 p, vec3 normal) {
  vec3 place;
  vec2 pixel;
  float inverse_z;
  if (!project_face(cameras[0], p, place, inverse_z) || !project_lens(cameras[0], p, pixel)) return false;
  vec3 right = from_cube_face(vec3(1.0, 0.0, 0.0), int(place.z)),
       down = from_cube_face(vec3(0.0, 1.0, 0.0), int(place.z));
  vec2 slope = vec2(dot(normal, right), dot(normal, down)) / (cameras[0].face.xy * dot(normal, p));  // per pixel
  vec2 blocks = floor((cameras[0].size.zw + 3.0) / 4.0);
  vec2 corner = floor((place.xy + 0.5) / 4.0 + 0.5);  // between the four
  vec3 at = vec3(corner / blocks, place.z);
  // Of each block: below left, below right, above right, above left.
  vec4 far = textureGather(blocks0, at, 0), near = textureGather(blocks0, at, 1);
  bool known = all(greaterThan(far, vec4(0.0))) && all(lessThan(far, vec4(1e29)));
  vec2 middle = 4.0 * corner - 0.5 - place.xy;
  vec4 x = middle.x + vec4(-2.0, 2.0, 2.0, -2.0), y = middle.y + vec4(2.0, 2.0, -2.0, -2.0);
  vec4 plane = inverse_z + slope.x * x + slope.y * y + 1.5 * (abs(slope.x) + abs(slope.y));  // at its nearest pixel
  bool is_free = all(lessThanEqual(near * (1.0 - kStandsBefore * depth_tolerance * plane), plane));
  return known && within(0, pixel) >= 1.0 && is_free;
}

float pixels_per_texel(int c, Tile t, vec3 p) {
  return sqrt(abs(determinant(footprint(c, p, t.right, t.down))));
}

void main() {
  int index = int(gl_WorkGroupSize.x) * first_group + int(gl_GlobalInvocationID.x);
  if (index >= tile_count) return;
  uint item = texelFetch(tiles, index).r;
  ivec2 in_page = 8 * ivec2(item & 1u, (item >> 1) & 1u);
  int page = int(item >> 2);
  Tile now = tile_of(page, 0, vec2(in_page)), before = tile_of(page, 1, vec2(in_page));
  ivec3 origin = slot_origin(uint(max(texelFetch(geometry, 8 * page).w, 0.0)), 0) + ivec3(in_page, 0);
  uint middle = texelFetch(heights, origin + ivec3(4, 4, 0), 0).r;
  vec3 p_now = point(now, vec2(4.0), middle), p_before = point(before, vec2(4.0), middle);
  bool coarser = pixels_per_texel(0, now, p_now) < worse * pixels_per_texel(1, before, p_before);
#if STEP == 0
  vec3 points[4];
  for (int i = 0; i < 4; ++i) {
    ivec2 at = 1 + 5 * ivec2(i & 1, i >> 1);
    uint raw = texelFetch(heights, origin + ivec3(at, 0), 0).r;
    points[i] = point(now, vec2(at), raw == 0u ? middle : raw);
  }
  vec3 normal = cross(points[1] - points[0], points[2] - points[0]);
  bool clear = true;
  for (int i = 0; i < 4; ++i) clear = clear && is_clear(points[i], normal);
  answers[index] = clear && !coarser ? 0u : 1u;
#else
  bool seen = false, hidden = true;
  int missed = 0;
  for (int i = 0; i < 16; ++i) {
    ivec2 at = (7 * ivec2(i & 3, i >> 2) + 1) / 3;
    uint raw = texelFetch(heights, origin + ivec3(at, 0), 0).r;
    float shown_before = raw == 0u ? 0.0 : shown(1, point(before, vec2(at), raw));
    float shown_now = raw == 0u ? 0.0 : shown(0, point(now, vec2(at), raw));
    seen = seen || shown_before > 0.0;
    hidden = hidden && shown_now <= 0.0;
    if (shown_before > shown_now + kLessSeen) ++missed;
  }
  answers[index] = (seen && coarser ? 3u : missed > 0 ? 1u : 0u) | (hidden ? 4u : 0u);
#endif
}
