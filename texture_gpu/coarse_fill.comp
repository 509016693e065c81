// Hole filling, above the pages: a page with hardly a seen texel takes the means of itself and the
// pages around it, the nearer and the more seen the more, and far from all of them its chart's. One invocation a page.
#define INVOCATIONS_PER_ITEM 1
#include "chart_record.glsl"
#include "atlas.glsl"
layout(local_size_x = 64) in;
#include "work_item.glsl"
layout(binding = 7) uniform usamplerBuffer chart_of_page;
layout(binding = 8) uniform samplerBuffer charts;
layout(binding = 9) uniform usamplerBuffer table;
layout(binding = 10) uniform samplerBuffer means;
layout(binding = 11) uniform sampler2DArray colours;
layout(binding = 0, rgba16f) uniform writeonly imageBuffer coarse;

const int kReach = 3;  // pages

void main() {
  uint page_index;
  if (!next_work(page_index)) return;
  int chart_index = int(texelFetch(chart_of_page, int(page_index)).r);
  ChartRecord chart = read_chart(charts, chart_index);
  int local = int(page_index) - chart.first_page;
  ivec2 page = ivec2(local % chart.pages.x, local / chart.pages.x);
  vec4 mean = texelFetch(means, chart_index);
  vec4 sum = 1e-4 * mean.a * vec4(mean.rgb, 1.0);
  for (int y = -kReach; y <= kReach; ++y)
    for (int x = -kReach; x <= kReach; ++x) {
      ivec2 at = page + ivec2(x, y);
      bool inside = all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, chart.pages));
      at = clamp(at, ivec2(0), chart.pages - 1);
      uint slot = texelFetch(table, chart.first_page + at.y * chart.pages.x + at.x).r;
      vec4 c = unpack_texel(texelFetch(colours, slot_origin(slot & 0xffffffu, 4), 4));
      float d2 = float(x * x + y * y);
      float weight = inside && slot != kNoSlot ? c.a / (d2 * d2 + 1.0) : 0.0;
      sum += weight * vec4(c.rgb, 1.0);
    }
  if (sum.a > 0.0) imageStore(coarse, int(page_index), vec4(sum.rgb / sum.a, 1.0));
}
