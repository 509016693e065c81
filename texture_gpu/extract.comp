// The heart of it: one back-projection per texel. A work group is one tile of 8x8 texels; each
// finds its surface point, asks the cameras whether they saw it, takes the sharper one's colour and
// keeps the old colour only where the new one is clearly worse.
//
// Defines: CAMERAS 1 or 2; MINIFY 1 where texels may be larger than pixels.
#include "camera.glsl"
#include "seen.glsl"
#include "atlas.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 7) uniform samplerBuffer geometry;  // per job and camera four texels (ChartAtlas::write_job_geometry)
layout(binding = 9) uniform usampler2DArray heights;
layout(binding = 10) uniform usamplerBuffer tiles;  // job << 4 | tile << 2 | cameras that may see it
layout(binding = 11) uniform sampler2DArray old_colours;
layout(binding = 0, rgba8) uniform writeonly image2DArray colours;
#include "holes.glsl"
uniform int first_group;
uniform float worse;  // new colours below this share of the old resolution do not replace them

// Factor from the image's values to the reference exposure (exposure.hpp).
float tone(int c, vec2 pixel) {
  vec2 half_size = 0.5 * (cameras[c].size.xy - 1.0);
  vec2 offset = (pixel - half_size) / length(half_size);
  float r2 = dot(offset, offset);
  return cameras[c].tone.x * exp(-r2 * (cameras[c].tone.y + r2 * cameras[c].tone.z));
}

vec3 fetch_image(int c, vec2 pixel, float lod) {
  vec2 uv = (pixel + 0.5) / cameras[c].size.xy;
  return c == 0 ? textureLod(image0, uv, lod).rgb : textureLod(image1, uv, lod).rgb;
}

// Colour over the texel's footprint. Up to about one pixel a single bilinear sample is it; above,
// taps along both axes of the footprint, from a level whose pixels are as large as their spacing.
vec3 sample_image(int c, vec2 pixel, mat2 axes) {
#if MINIFY
  vec2 lengths = vec2(length(axes[0]), length(axes[1]));
  ivec2 taps = ivec2(clamp(ceil(lengths - 0.5), vec2(1.0), vec2(4.0)));
  float spacing = max(lengths.x / float(taps.x), lengths.y / float(taps.y));
  float lod = max(log2(spacing), 0.0);
  vec3 sum = vec3(0.0);
  for (int j = 0; j < taps.y; ++j)
    for (int i = 0; i < taps.x; ++i) {
      vec2 t = (vec2(i, j) + 0.5) / vec2(taps) - 0.5;
      sum += fetch_image(c, pixel + axes * t, lod);
    }
  return sum / float(taps.x * taps.y);
#else
  // Catmull-Rom in five bilinear taps.
  vec2 center = floor(pixel) ;
  vec2 f = pixel - center;
  vec2 w0 = f * (-0.5 + f * (1.0 - 0.5 * f)), w1 = 1.0 + f * f * (-2.5 + 1.5 * f), w2 = f * (0.5 + f * (2.0 - 1.5 * f)),
       w3 = f * f * (-0.5 + 0.5 * f);
  vec2 w12 = w1 + w2, at12 = center + w2 / w12;
  vec4 wc = vec4(w12.x * w0.y, w0.x * w12.y, w3.x * w12.y, w12.x * w3.y);
  float wm = w12.x * w12.y;
  vec3 sum = wm * fetch_image(c, at12, 0.0) + wc.x * fetch_image(c, vec2(at12.x, center.y - 1.0), 0.0) + wc.y * fetch_image(c, vec2(center.x - 1.0, at12.y), 0.0) +
             wc.z * fetch_image(c, vec2(center.x + 2.0, at12.y), 0.0) + wc.w * fetch_image(c, vec2(at12.x, center.y + 2.0), 0.0);
  return clamp(sum / (wm + wc.x + wc.y + wc.z + wc.w), 0.0, 1.0);
#endif
}

void main() {
  uint tile = texelFetch(tiles, first_group + int(gl_WorkGroupID.x)).r;
  int job = int(tile >> 4);
  vec4 g0 = texelFetch(geometry, 4 * CAMERAS * job), g1 = texelFetch(geometry, 4 * CAMERAS * job + 1),
       g2 = texelFetch(geometry, 4 * CAMERAS * job + 2), g3 = texelFetch(geometry, 4 * CAMERAS * job + 3);
  ivec2 in_page = ivec2(gl_LocalInvocationID.xy) + 8 * ivec2((tile >> 2) & 1u, (tile >> 3) & 1u);
  uint raw = texelFetch(heights, slot_origin(uint(g0.w), 0) + ivec3(in_page, 0), 0).r;
  float height = float(raw & 0x7fffu) - 1.0;
  vec4 colour = g1.w < 0.0 ? vec4(0.0) : texelFetch(old_colours, slot_origin(uint(max(g1.w, 0.0)), 0) + ivec3(in_page, 0), 0);

  float before = colour.a;
  float best_quality = 0.0;
  vec4 best = vec4(0.0);
  for (int c = 0; c < CAMERAS; ++c) {
    if (c == 1) {
      g0 = texelFetch(geometry, 8 * job + 4), g1 = texelFetch(geometry, 8 * job + 5);
      g2 = texelFetch(geometry, 8 * job + 6), g3 = texelFetch(geometry, 8 * job + 7);
    }
    vec3 p = g0.xyz + float(in_page.x) * g1.xyz + float(in_page.y) * g2.xyz + height * g3.xyz;
    vec2 pixel;
    bool seen = is_seen(c, p, pixel) && raw != 0u && (tile & (1u << c)) != 0u;
    mat2 axes = footprint(c, p, g1.xyz, g2.xyz);
    float quality = sqrt(abs(determinant(axes)));
    if (seen && quality > best_quality) {
      best_quality = quality;
      best = vec4(sample_image(c, pixel, axes) * tone(c, pixel), encode_quality(quality));
    }
  }
  // The newest wins. What is clearly worse waits; the old colour's claim ages by one step
  // (1/32 of a doubling) for each image that would have replaced it.
  bool take = colour.a < kSeen || best.a >= colour.a + log2(worse) / 8.0 * 253.0 / 255.0;
  if (best_quality > 0.0) colour = take ? best : vec4(colour.rgb, max(colour.a - 1.0 / 255.0, 2.0 / 255.0));
  if (raw == 0u) colour = vec4(0.0);
  note_hole(job, raw, before, colour.a);
  imageStore(colours, slot_origin(uint(g2.w), 0) + ivec3(in_page, 0), colour);
}
