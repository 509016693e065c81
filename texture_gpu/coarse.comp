// Hole filling, above the pages: the mean colour of every page of the charts that changed, and of
// each such chart. Pages with hardly a seen texel are listed for coarse_fill.comp.
// One work group a chart.
#include "chart_record.glsl"
#include "atlas.glsl"
#include "work_list.glsl"
layout(local_size_x = 16) in;
layout(binding = 7) uniform usamplerBuffer dirty;  // charts that changed
layout(binding = 8) uniform samplerBuffer charts;
layout(binding = 9) uniform usamplerBuffer table;
layout(binding = 11) uniform sampler2DArray colours;
layout(binding = 0, rgba16f) uniform writeonly imageBuffer coarse;
layout(binding = 1, rgba16f) uniform writeonly imageBuffer means;
uniform int first_group;
shared vec4 sums[16];

// Share of seen texels from which a page's mean stands for itself; a handful at its edge does not.
const float kFirm = 0.25;

void main() {
  int index = int(texelFetch(dirty, first_group + int(gl_WorkGroupID.x)).r);
  int lane = int(gl_LocalInvocationID.x);
  ChartRecord chart = read_chart(charts, index);
  int count = chart.pages.x * chart.pages.y;
  vec4 sum = vec4(0.0);
  for (int i = lane; i < count; i += 16) {
    uint slot = texelFetch(table, chart.first_page + i).r;
    vec4 c = slot == kNoSlot ? vec4(0.0) : unpack_texel(texelFetch(colours, slot_origin(slot & 0xffffffu, 4), 4));
    sum += vec4(c.rgb * c.a, c.a);
    if (c.a < kFirm) append_work(uint(chart.first_page + i));
    imageStore(coarse, chart.first_page + i, c.a > 0.0 ? vec4(c.rgb, 1.0) : vec4(0.0));
  }
  sums[lane] = sum;
  barrier();
  if (lane != 0) return;
  vec4 total = vec4(0.0);
  for (int i = 0; i < 16; ++i) total += sums[i];
  imageStore(means, index, total.a > 0.0 ? vec4(total.rgb / total.a, 1.0) : vec4(0.0));
}
