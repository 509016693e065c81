// Carries the colours of a chart over to its new resolution: each new texel takes the old texels around its place, by a
// cubic filter: while a camera comes nearer, what it does not see any more is carried over again and again, and a linear one would
// blur it each time. One work group a tile, four a page.
#include "chart_record.glsl"
#include "atlas.glsl"
#include "jobs.glsl"
#define BRIGHTEST kBrightest
#define SHARP_FOR(finer) 1.0
#include "lookup.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 7) uniform usamplerBuffer jobs;
layout(binding = 8) uniform samplerBuffer charts;      // at the new resolution
layout(binding = 0, r32ui) uniform writeonly uimage2DArray colours;
uniform int first_group;

void main() {
  int group = first_group + int(gl_WorkGroupID.x);
  Job job = read_job(jobs, group >> 2);
  ivec2 in_page = ivec2(gl_LocalInvocationID.xy) + 8 * ivec2(group & 1, (group >> 1) & 1);
  ChartRecord fresh = read_chart(charts, job.chart), old = read_chart(published_charts, job.chart);
  vec2 uv = fresh.uv0 + vec2(16 * job.page + in_page) / fresh.density;
  // Coarser levels of the old pyramid where the new texels are larger.
  vec2 ratio = old.density / fresh.density;
  float lod = max(log2(min(ratio.x, ratio.y)), 0.0);
  vec2 texel = (uv - old.uv0) * old.density;
  int level = int(lod + 0.5);
  vec4 seen = level == 0 ? seen_colour(gather_sharp_taps(old, texel, 0, 1.0)) : seen_colour(old, texel, level);
  // Twice as many texels for the same pixels: each holds half as many pixels along a side.
  float shift = 0.5 * log2(ratio.x * ratio.y) * kStepsPerDoubling * kStep;
  vec4 colour = seen.a > 0.0 ? vec4(seen.rgb, clamp(seen.a + shift, kLeastSeen, 1.0)) : vec4(0.0);
  imageStore(colours, slot_origin(job.new_slot, 0) + ivec3(in_page, 0), pack_texel(colour));
}
