// The heart of it: one back-projection per texel. A work group is one tile of 8x8 texels; each
// finds its surface point, asks the cameras whether they saw it, takes the sharper one's colour and
// keeps the old colour only where the new one is clearly worse.
#include "camera.glsl"
#include "seen.glsl"
#include "chart_record.glsl"
#include "atlas.glsl"
#include "jobs.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 7) uniform usamplerBuffer jobs;
layout(binding = 8) uniform samplerBuffer charts;
layout(binding = 9) uniform usampler2DArray heights;
layout(binding = 10) uniform usamplerBuffer tiles;  // job << 4 | tile << 2 | cameras that may see it
layout(binding = 11) uniform sampler2DArray old_colours;
layout(binding = 0, rgba8) uniform writeonly image2DArray colours;
layout(binding = 0, std430) writeonly buffer Holes { uint holes[]; };  // per job: 1 where a texel has no seen colour
uniform int first_group;
uniform float worse;  // new colours below this share of the old resolution do not replace them

// Brightness that the lens takes away at a pixel, and the image's gain against the reference.
float tone(int c, vec2 pixel) {
  vec2 half_size = 0.5 * (cameras[c].size.xy - 1.0);
  vec2 offset = (pixel - half_size) / length(half_size);
  float r2 = dot(offset, offset);
  return cameras[c].tone.x / (1.0 + r2 * (cameras[c].tone.y + r2 * cameras[c].tone.z));
}

vec3 fetch_image(int c, vec2 pixel, float lod) {
  vec2 uv = (pixel + 0.5) / cameras[c].size.xy;
  return c == 0 ? textureLod(image0, uv, lod).rgb : textureLod(image1, uv, lod).rgb;
}

// Colour over the texel's footprint. Up to about one pixel a single bilinear sample is it; above,
// taps along both axes of the footprint, from a level whose pixels are as large as their spacing.
vec3 sample_image(int c, vec2 pixel, mat2 axes) {
  vec2 lengths = vec2(length(axes[0]), length(axes[1]));
  if (max(lengths.x, lengths.y) < 1.5) return fetch_image(c, pixel, 0.0);
  ivec2 taps = ivec2(clamp(ceil(lengths), vec2(1.0), vec2(4.0)));
  float spacing = max(lengths.x / float(taps.x), lengths.y / float(taps.y));
  float lod = max(log2(spacing), 0.0);
  vec3 sum = vec3(0.0);
  for (int j = 0; j < taps.y; ++j)
    for (int i = 0; i < taps.x; ++i) {
      vec2 t = (vec2(i, j) + 0.5) / vec2(taps) - 0.5;
      sum += fetch_image(c, pixel + axes * t, lod);
    }
  return sum / float(taps.x * taps.y);
}

void main() {
  uint tile_word = texelFetch(tiles, first_group + int(gl_WorkGroupID.x)).r;
  int job_index = int(tile_word >> 4);
  Job job = read_job(jobs, job_index);
  ivec2 in_page = ivec2(gl_LocalInvocationID.xy) + 8 * ivec2((tile_word >> 2) & 1u, (tile_word >> 3) & 1u);
  vec4 colour = job.old_slot == kNoSlot ? vec4(0.0) : texelFetch(old_colours, slot_origin(job.old_slot, 0) + ivec3(in_page, 0), 0);
  ivec3 target = slot_origin(job.new_slot, 0) + ivec3(in_page, 0);
  uint raw = texelFetch(heights, slot_origin(job.height_slot, 0) + ivec3(in_page, 0), 0).r;
  uint cameras_here = tile_word & 3u;
  if (raw != 0u && cameras_here != 0u) {
    ChartRecord chart = read_chart(charts, job.chart);
    vec2 texel = vec2(16 * job.page + in_page);
    vec3 p_node = chart.origin + texel.x * chart.eu + texel.y * chart.ev + (float(raw) - 1.0) * chart.eh;
    int best = -1;
    float best_quality = 0.0;
    vec2 best_pixel = vec2(0.0);
    mat2 best_axes = mat2(0.0);
    for (int c = 0; c < CAMERAS; ++c) {
      if ((cameras_here & (1u << c)) == 0u) continue;
      vec3 p = node_to_camera(node_poses, c * node_count + chart.node, p_node);
      vec2 pixel;
      if (!is_seen(c, p, pixel)) continue;
      mat2 axes = footprint(c, p, rotate_to_camera(node_poses, c * node_count + chart.node, chart.eu),
                            rotate_to_camera(node_poses, c * node_count + chart.node, chart.ev));
      float quality = sqrt(abs(determinant(axes)));
      if (quality > best_quality) best = c, best_quality = quality, best_pixel = pixel, best_axes = axes;
    }
    float code = encode_quality(best_quality);
    // The newest wins. What is clearly worse waits; the old colour's claim ages by one step
    // (1/32 of a doubling) for each image that would have replaced it.
    if (best >= 0 && (colour.a < kSeen || code >= colour.a + log2(worse) / 8.0 * 253.0 / 255.0))
      colour = vec4(sample_image(best, best_pixel, best_axes) * tone(best, best_pixel), code);
    else if (best >= 0)
      colour.a = max(colour.a - 1.0 / 255.0, 2.0 / 255.0);
  }
  if (raw == 0u) colour = vec4(0.0);
  if (raw != 0u && colour.a < kSeen) holes[job_index] = 1u;
  imageStore(colours, target, colour);
}
