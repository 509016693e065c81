// The heart of it: one back-projection per texel. A work group goes through four tiles of 8x8 texels;
// an invocation takes four texels below each other, so that what they share is found once. Each
// texel finds its surface point, asks the cameras whether they saw it, takes the first one's colour, or the other's where
// that is clearly sharper, and keeps the old colour only where the new one is clearly worse.
//
// Defines: CAMERAS 1 or 2; TEXELS 0 to 4: as large as pixels, up to two, four, eight times as large, larger
// (ExtractPass::Work::minify_above).
#include "camera.glsl"
#include "seen.glsl"
#include "image_taps.glsl"
#include "vignetting.glsl"
#include "atlas.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 7) uniform samplerBuffer geometry;  // per job and camera four texels (ChartAtlas::write_job_geometry)
layout(binding = 9) uniform usampler2DArray heights;
layout(binding = 10) uniform usamplerBuffer tiles;  // job << 4 | tile << 2 | cameras that may see it
layout(binding = 11) uniform sampler2DArray old_colours;
layout(binding = 0, r32ui) uniform writeonly uimage2DArray colours;
#include "holes.glsl"
uniform int first_group, tile_count;
uniform int image_number;
const int kImagesToAge = 8;  // a power of two: remainders are slow
const float kBeyondWhite = 0.35;
const float kFiner = 1.5;  // than the first camera: of two about equal ones each change is a seam

// Factor from the image's values to the reference exposure (exposure.hpp).
float tone(int c, vec2 pixel) {
  return cameras[c].tone.x * without_vignetting(cameras[c].tone, pixel, cameras[c].size.xy);
}

vec4 fetch_image(int c, vec2 pixel, float lod) {
  vec2 uv = (pixel + 0.5) / cameras[c].size.xy;
  return c == 0 ? textureLod(image0, uv, lod) : textureLod(image1, uv, lod);
}

// Colour over the texel's footprint. Up to about one pixel a single bilinear sample is it; above,
// taps along both axes of the footprint, from a level whose pixels are as large as their spacing.
vec4 sample_image(int c, vec2 pixel, mat2 axes) {
#if TEXELS >= 1 && TEXELS <= 3
  // Bilinear taps in the middles of the footprint's 2x2, 4x4 or 8x8 parts. Where texels are so large
  // there are few of them: cheaper than coarser levels of the image.
  const int kSide = 1 << TEXELS;
  vec4 sum = vec4(0.0);
  for (int i = 0; i < kSide * kSide; ++i)
    sum += fetch_image(c, pixel + axes * ((vec2(i % kSide, i / kSide) + 0.5) / float(kSide) - 0.5), 0.0);
  return sum / float(kSide * kSide);
#elif TEXELS == 4
  vec2 lengths = vec2(length(axes[0]), length(axes[1]));
  ivec2 taps = ivec2(clamp(ceil(lengths - 0.5), vec2(1.0), vec2(4.0)));
  float spacing = max(lengths.x / float(taps.x), lengths.y / float(taps.y));
  float lod = max(log2(spacing), 0.0);
  vec4 sum = vec4(0.0);
  for (int j = 0; j < taps.y; ++j)
    for (int i = 0; i < taps.x; ++i) {
      vec2 t = (vec2(i, j) + 0.5) / vec2(taps) - 0.5;
      sum += fetch_image(c, pixel + axes * t, lod);
    }
  return sum / float(taps.x * taps.y);
#else
  vec2 size = cameras[c].size.xy;
  return c == 0 ? sample_sharply(image0, pixel, size, 1.0) : sample_sharply(image1, pixel, size, 1.0);
#endif
}

// What `scaled`, a colour of an image (0..1), says of a texel, at the reference exposure, which is `factor` away;
// `old`: what was known, or -1. White pixels tell only that the surface is at least so bright, black
// ones that it is at most so bright: an older value that agrees is better, and at the exposure
// of this image it looks the same. Where there is none, white is taken as a third brighter than the
// least that it can be: while the camera closes by a stop it stays white.
const float kWhite = 249.5 / 255.0, kBlack = 1.5 / 255.0;
vec3 fused(vec3 old, vec4 scaled, float factor) {
  vec3 value = scaled.rgb, fresh = unscaled(scaled) * factor;
  vec3 guess = fresh * (1.0 + kBeyondWhite * clamp((value - kWhite) / (1.0 - kWhite), 0.0, 1.0));
  vec3 white = step(kWhite, value) * step(0.97 * fresh, old);
  vec3 black = step(value, vec3(kBlack)) * step(0.0, old.r);
  return mix(mix(guess, max(old, fresh), white), min(old, vec3(kBlack * factor)), black);
}

// Four texels below each other: what one camera needs to know of them.
struct View {
  vec3 first, down, height;  // camera frame: the first texel's foot, the next one's offset, a unit of height
  mat2 axes;                 // pixels per texel along the texel axes, at the middle
  float quality;             // pixels per texel; 0: this camera does not see the tile
};
struct Column {
  uint tile;
  bool has_old;
  float worse;  // new colours below this share of the old resolution do not replace them
  ivec3 heights_at, old_at, new_at;
  View views[CAMERAS];
};
const int kRows = 4;

// `at`: of the heights, where a page stays.
float aged(float code, ivec3 at) {
  bool its_turn = ((at.x + 3 * at.y + image_number) & (kImagesToAge - 1)) == 0;
  return its_turn ? max(code - kStep, kLeastSeen) : code;
}

void extract_texel(Column column, int row) {
  ivec3 below = ivec3(0, row, 0);
  uint raw = texelFetch(heights, column.heights_at + below, 0).r;
  float height = float(raw & 0x7fffu) - 1.0;
  vec4 colour = unpack_texel(column.has_old ? texelFetch(old_colours, column.old_at + below, 0) : vec4(0.0));
  float before = colour.a;
  float best_quality = 0.0;
  float code = 0.0;
  vec4 sampled = vec4(0.0);
  float best_tone = 1.0;
  for (int c = 0; c < CAMERAS; ++c) {
    View view = column.views[c];
    vec2 pixel;
    bool seen = is_seen(c, view.first + float(row) * view.down + height * view.height, pixel) && raw != 0u;
    if (seen && view.quality > kFiner * best_quality) {
      best_quality = view.quality;
      code = encode_quality(view.quality);
      sampled = sample_image(c, pixel, view.axes);
      best_tone = tone(c, pixel);
    }
  }
  // The newest wins. What is clearly worse waits; the old colour's claim ages by one step (1/3.6 of a doubling) with every
  // eighth image that would have replaced it. Texels take turns, so that a surface changes little by little.
  bool take = colour.a < kSeen || code >= colour.a + log2(max(column.worse, 1e-6)) * kStepsPerDoubling * kStep;
  vec4 best = vec4(fused(colour.a < kSeen ? vec3(-1.0) : colour.rgb, sampled, best_tone), code);
  if (best_quality > 0.0) colour = take ? best : vec4(colour.rgb, aged(colour.a, column.heights_at + below));
  if (raw == 0u) colour = vec4(0.0);
  note_hole(int(column.tile >> 2), raw, before, colour.a);
  imageStore(colours, column.new_at + below, pack_texel(colour));
}

void main() {
  int index = 4 * (first_group + int(gl_WorkGroupID.x)) + int(gl_LocalInvocationID.y >> 1);
  if (index >= tile_count) return;
  Column column;
  column.tile = texelFetch(tiles, index).r;
  int job = int(column.tile >> 4);
  ivec2 first = ivec2(gl_LocalInvocationID.x, (gl_LocalInvocationID.y & 1u) * kRows) +
                8 * ivec2((column.tile >> 2) & 1u, (column.tile >> 3) & 1u);
  for (int c = 0; c < CAMERAS; ++c) {
    int at = 4 * (CAMERAS * job + c);
    vec4 corner = texelFetch(geometry, at), eu = texelFetch(geometry, at + 1), ev = texelFetch(geometry, at + 2),
         eh = texelFetch(geometry, at + 3);
    vec3 foot = corner.xyz + float(first.x) * eu.xyz + float(first.y) * ev.xyz;
    // The height in the middle decides for all four: the resolution hardly changes within a tile.
    column.heights_at = slot_origin(uint(corner.w), 0) + ivec3(first, 0);
    float middle = float(texelFetch(heights, column.heights_at + ivec3(0, kRows / 2, 0), 0).r & 0x7fffu);
    vec3 p = foot + 0.5 * float(kRows) * ev.xyz + middle * eh.xyz;
    mat2 axes = footprint(c, p, eu.xyz, ev.xyz);
    float quality = (column.tile & (1u << c)) != 0u ? sqrt(abs(determinant(axes))) : 0.0;
    column.views[c] = View(foot, ev.xyz, eh.xyz, axes, quality);
    column.has_old = eu.w >= 0.0;
    column.worse = eh.w;
    column.old_at = slot_origin(uint(max(eu.w, 0.0)), 0) + ivec3(first, 0);
    column.new_at = slot_origin(uint(ev.w), 0) + ivec3(first, 0);
  }
  // Written out, not looped over: software renderers keep all of a loop's variables in memory.
  extract_texel(column, 0);
  extract_texel(column, 1);
  extract_texel(column, 2);
  extract_texel(column, 3);
}
