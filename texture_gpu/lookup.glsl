// Colours of a published generation at a point of a chart. Needs chart_record.glsl, atlas.glsl.
layout(binding = 11) uniform usamplerBuffer published_table;   // slot of each page, kNoSlot: none
layout(binding = 12) uniform samplerBuffer published_charts;
layout(binding = 13) uniform sampler2DArray published_colours;
layout(binding = 14) uniform usamplerBuffer published_coarse;  // filled mean colour of each page, RGBA8
layout(binding = 15) uniform usamplerBuffer published_means;   // filled mean colour of each chart, RGBA8

struct Taps {
  vec4 seen;     // rgb times weight, weight; of texels that a camera saw
  float quality;  // alpha code times weight, of the same
  vec4 filled;   // of filled texels
};

// The four texels of a level around `texel` (level-0 texels, centres at integers).
Taps gather_taps(ChartRecord chart, vec2 texel, int level) {
  vec2 at = (texel + 0.5) / float(1 << level) - 0.5;
  ivec2 base = ivec2(floor(at));
  vec2 f = at - vec2(base);
  Taps taps = Taps(vec4(0.0), 0.0, vec4(0.0));
  int shift = 4 - level;
  int in_page = (1 << shift) - 1;
  for (int i = 0; i < 4; ++i) {
    ivec2 o = ivec2(i & 1, i >> 1);
    ivec2 t = base + o;
    ivec2 page = t >> shift;
    if (any(lessThan(t, ivec2(0))) || any(greaterThanEqual(page, chart.pages))) continue;
    uint slot = texelFetch(published_table, chart.first_page + page.y * chart.pages.x + page.x).r;
    if (slot == kNoSlot) continue;
    vec4 c = texelFetch(published_colours, slot_origin(slot, level) + ivec3(t & in_page, 0), level);
    float w = (o.x == 1 ? f.x : 1.0 - f.x) * (o.y == 1 ? f.y : 1.0 - f.y);
    // Level 0 tells seen from filled by the code; above, alpha is the share of seen texels.
    float seen = level == 0 ? step(kSeen, c.a) : step(1.5 / 255.0, c.a) * c.a;
    taps.seen += w * seen * vec4(c.rgb, 1.0);
    taps.quality += w * seen * (level == 0 ? c.a : 1.0);
    taps.filled += w * (1.0 - seen) * step(0.5 / 255.0, c.a) * vec4(c.rgb, 1.0);
  }
  return taps;
}

// Colour and resolution code (alpha) from seen texels only; alpha 0 where there is none.
vec4 seen_colour(ChartRecord chart, vec2 texel, int level) {
  if (chart.density.x <= 0.0) return vec4(0.0);
  Taps taps = gather_taps(chart, texel, min(level, 4));
  return taps.seen.a > 0.25 ? vec4(taps.seen.rgb, taps.quality) / taps.seen.a : vec4(0.0);
}

// What stands in for a page without colours of its own: the filled means of the pages around the
// point, interpolated between their centres, else the chart's mean.
vec4 coarse_colour(ChartRecord chart, int chart_index, vec2 texel) {
  vec2 at = (texel + 0.5) / 16.0 - 0.5;
  ivec2 base = ivec2(floor(at));
  vec2 f = at - vec2(base);
  vec4 sum = vec4(0.0);
  for (int i = 0; i < 4; ++i) {
    ivec2 o = ivec2(i & 1, i >> 1);
    ivec2 page = clamp(base + o, ivec2(0), chart.pages - 1);
    vec4 c = unpackUnorm4x8(texelFetch(published_coarse, chart.first_page + page.y * chart.pages.x + page.x).r);
    float w = (o.x == 1 ? f.x : 1.0 - f.x) * (o.y == 1 ? f.y : 1.0 - f.y);
    sum += w * c.a * vec4(c.rgb, 1.0);
  }
  return sum.a > 0.0 ? vec4(sum.rgb / sum.a, 1.0) : unpackUnorm4x8(texelFetch(published_means, chart_index).r);
}
