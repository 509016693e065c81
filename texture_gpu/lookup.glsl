// Colours of a published generation at a point of a chart. Needs chart_record.glsl, atlas.glsl, and
// BRIGHTEST: the texel value that is white at the exposure shown. Texels may be brighter, a camera's
// pixels may not; cut off before the filter, what is white bleeds no more than it does in an image.
layout(binding = 11) uniform usamplerBuffer published_table;   // slot of each page, kNoSlot: none
layout(binding = 12) uniform samplerBuffer published_charts;
layout(binding = 13) uniform sampler2DArray published_colours;
layout(binding = 14) uniform samplerBuffer published_coarse;  // filled mean colour of each page
layout(binding = 15) uniform samplerBuffer published_means;   // filled mean colour of each chart

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
    c.rgb = min(c.rgb, vec3(BRIGHTEST));
    float w = (o.x == 1 ? f.x : 1.0 - f.x) * (o.y == 1 ? f.y : 1.0 - f.y);
    // Level 0 tells seen from filled by the code; above, alpha is the share of seen texels.
    float seen = level == 0 ? step(kSeen, c.a) : step(1.5 / 255.0, c.a) * c.a;
    taps.seen += w * seen * vec4(c.rgb, 1.0);
    taps.quality += w * seen * (level == 0 ? c.a : 1.0);
    taps.filled += w * (1.0 - seen) * step(0.5 / 255.0, c.a) * vec4(c.rgb, 1.0);
  }
  return taps;
}

// Share of the cubic filter; the rest is linear. More shows errors of the registration more sharply too.
const float kSharp = 0.6;

// Catmull-Rom weights of the texels at -1, 0, 1 and 2.
vec4 cubic_weights(float f) {
  return vec4(f * (-0.5 + f * (1.0 - 0.5 * f)), 1.0 + f * f * (-2.5 + 1.5 * f), f * (0.5 + f * (2.0 - 1.5 * f)),
              f * f * (-0.5 + 0.5 * f));
}

// As gather_taps() at level 0, but cubic where all 16 texels around the point are seen: two linear
// filters one after the other, in the extraction and here, would blur.
Taps gather_sharp_taps(ChartRecord chart, vec2 texel) {
  ivec2 base = ivec2(floor(texel));
  vec2 f = texel - vec2(base);
  vec4 wx = cubic_weights(f.x), wy = cubic_weights(f.y);
  ivec2 first_page = (base - 1) >> 4;  // the texels lie on at most 2x2 pages
  uint slots[4];
  for (int i = 0; i < 4; ++i) {
    ivec2 page = first_page + ivec2(i & 1, i >> 1);
    bool inside = all(greaterThanEqual(page, ivec2(0))) && all(lessThan(page, chart.pages));
    slots[i] = inside ? texelFetch(published_table, chart.first_page + page.y * chart.pages.x + page.x).r : kNoSlot;
  }
  Taps taps = Taps(vec4(0.0), 0.0, vec4(0.0));
  vec4 cubic = vec4(0.0);
  float all_seen = 1.0;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) {
      ivec2 t = base + ivec2(i - 1, j - 1);
      ivec2 page = (t >> 4) - first_page;
      uint slot = page.y == 0 ? (page.x == 0 ? slots[0] : slots[1]) : (page.x == 0 ? slots[2] : slots[3]);
      vec4 c = slot == kNoSlot ? vec4(0.0)
                               : texelFetch(published_colours, slot_origin(slot & 0xffffffu, 0) + ivec3(t & 15, 0), 0);
      c.rgb = min(c.rgb, vec3(BRIGHTEST));
      float seen = step(kSeen, c.a);
      all_seen *= seen;
      cubic += wx[i] * wy[j] * vec4(c.rgb, 1.0);
      bool inner = (i == 1 || i == 2) && (j == 1 || j == 2);
      float w = inner ? (i == 2 ? f.x : 1.0 - f.x) * (j == 2 ? f.y : 1.0 - f.y) : 0.0;
      taps.seen += w * seen * vec4(c.rgb, 1.0);
      taps.quality += w * seen * c.a;
      taps.filled += w * (1.0 - seen) * step(0.5 / 255.0, c.a) * vec4(c.rgb, 1.0);
    }
  if (all_seen > 0.5) taps.seen = vec4(clamp(mix(taps.seen.rgb, cubic.rgb / cubic.a, kSharp), 0.0, BRIGHTEST), 1.0);
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
    vec4 c = texelFetch(published_coarse, chart.first_page + page.y * chart.pages.x + page.x);
    float w = (o.x == 1 ? f.x : 1.0 - f.x) * (o.y == 1 ? f.y : 1.0 - f.y);
    sum += w * c.a * vec4(c.rgb, 1.0);
  }
  return sum.a > 0.0 ? vec4(sum.rgb / sum.a, 1.0) : texelFetch(published_means, chart_index);
}
