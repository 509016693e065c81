// Hole filling, downwards: texels of a level without (enough) seen texels under them take the
// level above, interpolated across page borders. Pages without holes are left alone.
// LEVEL is the level written; work groups as hole_jobs.comp listed them.
#include "chart_record.glsl"
#include "atlas.glsl"
#include "jobs.glsl"
#include "work_item.glsl"
#if LEVEL == 0
layout(local_size_x = 8, local_size_y = 8) in;  // one group a tile
#else
layout(local_size_x = 16 >> LEVEL, local_size_y = 16 >> LEVEL) in;  // one group a page
#endif
layout(binding = 7) uniform usamplerBuffer jobs;
layout(binding = 8) uniform samplerBuffer charts;
layout(binding = 9) uniform usamplerBuffer table;
layout(binding = 14) uniform samplerBuffer coarse;
layout(binding = 0, r32ui) uniform uimage2DArray colours;
layout(binding = 1, rgba8) uniform readonly image2DArray above;

const int kSide = 16 >> LEVEL;  // texels of a page at this level

vec4 parent(ChartRecord chart, ivec2 at) {
  const int shift = 3 - LEVEL;  // log2 of the page's side one level up
  ivec2 page = at >> shift;
  if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(page, chart.pages))) return vec4(0.0);
  int index = chart.first_page + page.y * chart.pages.x + page.x;
  vec4 c = vec4(0.0);
#if LEVEL < 3
  uint slot = texelFetch(table, index).r;
  if (slot != kNoSlot) c = unpack_texel(imageLoad(above, slot_origin(slot, LEVEL + 1) + ivec3(at & ((1 << shift) - 1), 0)));
#endif
  return c.a > 0.0 ? c : texelFetch(coarse, index);
}

void main() {
  uint item;
  if (!next_work(item)) return;
  ivec2 in_page = ivec2(gl_LocalInvocationID.xy);
#if LEVEL == 0
  in_page += 8 * ivec2(item & 1u, (item >> 1) & 1u);
  Job job = read_job(jobs, int(item >> 2));
#else
  Job job = read_job(jobs, int(item));
#endif
  ivec3 place = slot_origin(job.new_slot, LEVEL) + ivec3(in_page, 0);
  vec4 own = unpack_texel(unpackUnorm4x8(imageLoad(colours, place).r));
#if LEVEL == 0
  if (own.a >= kSeen) return;
#else
  if (own.a >= 0.5) return;
#endif
  ChartRecord chart = read_chart(charts, job.chart);
  vec2 up = (vec2(kSide * job.page + in_page) + 0.5) / 2.0 - 0.5;
  ivec2 base = ivec2(floor(up));
  vec2 f = up - vec2(base);
  vec4 sum = vec4(0.0);
  for (int i = 0; i < 4; ++i) {
    ivec2 o = ivec2(i & 1, i >> 1);
    vec4 c = parent(chart, base + o);
    float w = (o.x == 1 ? f.x : 1.0 - f.x) * (o.y == 1 ? f.y : 1.0 - f.y);
    if (c.a > 0.0) sum += w * vec4(c.rgb, 1.0);
  }
  if (sum.a == 0.0) return;
  vec3 from_above = sum.rgb / sum.a;
#if LEVEL == 0
  imageStore(colours, place, pack_texel(vec4(from_above, kFilled)));
#else
  // Keeps its share of seen texels, but never less than the least that marks a colour.
  float share = own.a < kSeen ? 0.0 : 2.0 * own.a;
  imageStore(colours, place, pack_texel(vec4(mix(from_above, own.rgb, share), max(own.a, kFilled))));
#endif
}
