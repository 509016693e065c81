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
    vec4 c = unpack_texel(texelFetch(published_colours, slot_origin(slot, level) + ivec3(t & in_page, 0), level));
    c.rgb = min(c.rgb, vec3(BRIGHTEST));
    float w = (o.x == 1 ? f.x : 1.0 - f.x) * (o.y == 1 ? f.y : 1.0 - f.y);
    // Level 0 tells seen from filled by the code; above, alpha is the share of seen texels.
    float seen = level == 0 ? step(kSeen, c.a) : step(kSeen, c.a) * c.a;
    taps.seen += w * seen * vec4(c.rgb, 1.0);
    taps.quality += w * seen * (level == 0 ? c.a : 1.0);
    taps.filled += w * (1.0 - seen) * step(kColoured, c.a) * vec4(c.rgb, 1.0);
  }
  return taps;
}

#ifdef SHARP_FOR  // (finer): share of the cubic filter (sharpness.hpp) where so many of the image's pixels are one here; the rest is linear
const int kCoarsestSharp = 2;  // level; of coarser ones the texels lie on more than 2x2 pages
const float kAllSeen = 0.999;  // alpha above level 0

// Catmull-Rom weights of the texels at -1, 0, 1 and 2.
vec4 cubic_weights(float f) {
  return vec4(f * (-0.5 + f * (1.0 - 0.5 * f)), 1.0 + f * f * (-2.5 + 1.5 * f), f * (0.5 + f * (2.0 - 1.5 * f)),
              f * f * (-0.5 + 0.5 * f));
}

struct SharpTaps {
  Taps linear;
  vec4 cubic;
  float least;  // alpha
};

// Slots of 2x2 pages.
struct FourPages {
  uint first, right, below, opposite;
};

uint slot_of_page(ChartRecord chart, ivec2 page) {
  bool inside = all(greaterThanEqual(page, ivec2(0))) && all(lessThan(page, chart.pages));
  uint slot = texelFetch(published_table, inside ? chart.first_page + page.y * chart.pages.x + page.x : 0).r;
  return inside ? slot : kNoSlot;
}

// Adds the level's texel at `place`, counted from the first page's corner, with its weights in both filters.
void add_tap(inout SharpTaps sum, FourPages pages, int level, ivec2 place, float cubic, float linear) {
  int side = 16 >> level;
  uint slot = place.y < side ? (place.x < side ? pages.first : pages.right) : (place.x < side ? pages.below : pages.opposite);
  ivec3 texel = slot_origin(slot & 0xffffffu, level) + ivec3(place & (side - 1), 0);
  vec4 c = unpack_texel(texelFetch(published_colours, texel, level));
  float alpha = slot == kNoSlot ? 0.0 : c.a;
  vec4 colour = vec4(min(c.rgb, vec3(BRIGHTEST)), 1.0);
  float seen = step(kSeen, alpha) * (level == 0 ? 1.0 : alpha);
  sum.least = min(sum.least, alpha);
  sum.cubic += cubic * colour;
  sum.linear.seen += linear * seen * colour;
  sum.linear.quality += linear * seen * (level == 0 ? alpha : 1.0);
  sum.linear.filled += linear * (1.0 - seen) * step(kColoured, alpha) * colour;
}

// As gather_taps() at a level up to kCoarsestSharp, but cubic where all texels that it takes were seen: two linear filters
// one after the other, in the extraction and here, would blur. `finer`: texels of the level for one here. Of the 4x4
// texels around the point it takes the inner four, and outside of them those of the nearest row and column for all on
// that side: the others hardly differ, and each costs as much as any other. Written out, as software renderers keep all of
// a loop's variables in memory.
//
//      . o .  .
//      o i i  o       o: with the weight of its side
//      . i i  .
//      . o .  .
Taps gather_sharp_taps(ChartRecord chart, vec2 texel, int level, float finer) {
  vec2 at = (texel + 0.5) / float(1 << level) - 0.5;
  ivec2 base = ivec2(floor(at));
  vec2 f = at - vec2(base), g = 1.0 - f;
  vec4 wx = cubic_weights(f.x), wy = cubic_weights(f.y);
  float inner_x = wx.y + wx.z, inner_y = wy.y + wy.z;
  ivec2 page = (base - 1) >> (4 - level);  // the texels lie on at most 2x2 pages
  FourPages pages = FourPages(slot_of_page(chart, page), slot_of_page(chart, page + ivec2(1, 0)),
                              slot_of_page(chart, page + ivec2(0, 1)), slot_of_page(chart, page + 1));
  ivec2 first = (base - 1) & ((16 >> level) - 1);
  ivec2 nearest = first + 1 + ivec2(step(0.5, f));
  SharpTaps sum = SharpTaps(Taps(vec4(0.0), 0.0, vec4(0.0)), vec4(0.0), 1.0);
  add_tap(sum, pages, level, first + ivec2(1, 1), wx.y * wy.y, g.x * g.y);
  add_tap(sum, pages, level, first + ivec2(2, 1), wx.z * wy.y, f.x * g.y);
  add_tap(sum, pages, level, first + ivec2(1, 2), wx.y * wy.z, g.x * f.y);
  add_tap(sum, pages, level, first + ivec2(2, 2), wx.z * wy.z, f.x * f.y);
  add_tap(sum, pages, level, ivec2(first.x, nearest.y), wx.x * inner_y, 0.0);
  add_tap(sum, pages, level, ivec2(first.x + 3, nearest.y), wx.w * inner_y, 0.0);
  add_tap(sum, pages, level, ivec2(nearest.x, first.y), wy.x * inner_x, 0.0);
  add_tap(sum, pages, level, ivec2(nearest.x, first.y + 3), wy.w * inner_x, 0.0);
  float share = SHARP_FOR(finer * (level == 0 ? decode_quality(sum.linear.quality) : 1.0));
  if (sum.least >= (level == 0 ? kSeen : kAllSeen))
    sum.linear.seen = vec4(clamp(mix(sum.linear.seen.rgb, sum.cubic.rgb / sum.cubic.a, share), vec3(0.0), vec3(BRIGHTEST)), 1.0);
  return sum.linear;
}
#endif

// Colour and resolution code (alpha) from seen texels only; alpha 0 where there is none.
vec4 seen_colour(Taps taps) {
  return taps.seen.a > 0.25 ? vec4(taps.seen.rgb, taps.quality) / taps.seen.a : vec4(0.0);
}

vec4 seen_colour(ChartRecord chart, vec2 texel, int level) {
  return chart.density.x > 0.0 ? seen_colour(gather_taps(chart, texel, min(level, 4))) : vec4(0.0);
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
