// Hole filling, above the pages: a mean colour for every page of every chart, and one for the
// chart. Pages without a seen texel take the means of the pages around them, the nearer the more.
// One work group a chart.
#include "chart_record.glsl"
#include "atlas.glsl"
layout(local_size_x = 64) in;
layout(binding = 8) uniform samplerBuffer charts;
layout(binding = 10) uniform usamplerBuffer table;
layout(binding = 11) uniform sampler2DArray colours;
layout(binding = 12) uniform samplerBuffer published_charts;
layout(binding = 14) uniform usamplerBuffer published_coarse;
layout(binding = 15) uniform usamplerBuffer published_means;
layout(binding = 9) uniform usamplerBuffer dirty;  // per chart: 1 where a page changed
layout(binding = 0, r32ui) uniform writeonly uimageBuffer coarse;
layout(binding = 1, r32ui) uniform writeonly uimageBuffer means;
uniform int chart_count;
uniform int first_group;
shared vec4 sums[64];

const int kReach = 4;  // pages

vec4 page_mean(ChartRecord chart, ivec2 page) {
  if (any(lessThan(page, ivec2(0))) || any(greaterThanEqual(page, chart.pages))) return vec4(0.0);
  uint slot = texelFetch(table, chart.first_page + page.y * chart.pages.x + page.x).r;
  return slot == kNoSlot ? vec4(0.0) : texelFetch(colours, slot_origin(slot, 4), 4);
}

void main() {
  int index = first_group + int(gl_WorkGroupID.x);
  int lane = int(gl_LocalInvocationID.x);
  ChartRecord chart = read_chart(charts, index);
  int count = chart.pages.x * chart.pages.y;
  if (texelFetch(dirty, index).r == 0u) {
    ChartRecord old = read_chart(published_charts, index);
    for (int i = lane; i < count; i += 64)
      imageStore(coarse, chart.first_page + i, texelFetch(published_coarse, old.first_page + i));
    if (lane == 0) imageStore(means, index, texelFetch(published_means, index));
    return;
  }
  vec4 sum = vec4(0.0);
  for (int i = lane; i < count; i += 64) {
    vec4 c = page_mean(chart, ivec2(i % chart.pages.x, i / chart.pages.x));
    sum += vec4(c.rgb * c.a, c.a);
  }
  sums[lane] = sum;
  barrier();
  vec4 total = vec4(0.0);
  for (int i = 0; i < 64; ++i) total += sums[i];
  vec4 mean = total.a > 0.0 ? vec4(total.rgb / total.a, 1.0) : vec4(0.0);
  for (int i = lane; i < count; i += 64) {
    ivec2 page = ivec2(i % chart.pages.x, i / chart.pages.x);
    vec4 own = page_mean(chart, page);
    if (own.a == 0.0 && mean.a > 0.0) {
      vec4 near = 1e-4 * mean;
      for (int y = -kReach; y <= kReach; ++y)
        for (int x = -kReach; x <= kReach; ++x) {
          vec4 c = page_mean(chart, page + ivec2(x, y));
          float d2 = float(x * x + y * y);
          near += c.a / (d2 * d2 + 1.0) * vec4(c.rgb, 1.0);
        }
      own = near / near.a;
    }
    imageStore(coarse, chart.first_page + i, uvec4(packUnorm4x8(vec4(own.rgb, own.a > 0.0 ? 1.0 : 0.0))));
  }
  if (lane == 0) imageStore(means, index, uvec4(packUnorm4x8(mean)));
}
