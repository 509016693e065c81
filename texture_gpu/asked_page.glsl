// The pages that are asked about, and the 4x4 points of each at which images are looked up. Needs
// chart_record.glsl and atlas.glsl.
layout(binding = 7) uniform usamplerBuffer pages;  // as in cull.comp
layout(binding = 8) uniform samplerBuffer charts;  // as planned
layout(binding = 9) uniform usampler2DArray heights;
uniform int page_count;

struct AskedPage {
  int chart_index;
  ChartRecord chart;
  ivec2 at;          // page of the chart
  ivec3 heights_at;  // its first texel
};

bool is_asked(int number) {
  return number < page_count;
}

// False where the page has no place.
bool read_page(int number, out AskedPage page) {
  uvec4 record = texelFetch(pages, 3 * number);
  if (record.z == kNoSlot) return false;
  page = AskedPage(int(record.x), read_chart(charts, int(record.x)), ivec2(record.y & 0xffffu, record.y >> 16),
                   slot_origin(record.z, 0));
  return true;
}

// Of 16: its texel of the page.
ivec2 texel_of_point(int i) {
  return ivec2(i & 3, i >> 2) * 4 + 2;
}

// False where the texel has no surface.
bool find_point(AskedPage page, ivec2 texel, out vec3 p_node) {
  uint raw = texelFetch(heights, page.heights_at + ivec3(texel, 0), 0).r;
  vec2 t = vec2(16 * page.at + texel);
  p_node = page.chart.origin + t.x * page.chart.eu + t.y * page.chart.ev + (float(raw & 0x7fffu) - 1.0) * page.chart.eh;
  return raw != 0u;
}
