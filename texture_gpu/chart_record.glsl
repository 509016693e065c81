// One chart at its present resolution, five texels of the samplerBuffer `charts`.
// C++ side: texture_gpu/chart_atlas.cpp.
struct ChartRecord {
  vec3 origin;      // node frame: centre of texel (0, 0) at raw height 1
  vec3 eu, ev;      // metres per texel
  vec3 eh;          // metres per unit of raw height
  int node;
  ivec2 pages;      // pages in a row, rows of pages
  int first_page;   // in the page table
  vec2 uv0;         // centre of texel (0, 0) on the patch's plane, metres
  vec2 density;     // texels per metre along u and v; 0: the chart has no texels yet
};

ChartRecord read_chart(samplerBuffer charts, int index) {
  vec4 a = texelFetch(charts, 5 * index), b = texelFetch(charts, 5 * index + 1), c = texelFetch(charts, 5 * index + 2),
       d = texelFetch(charts, 5 * index + 3), e = texelFetch(charts, 5 * index + 4);
  return ChartRecord(a.xyz, b.xyz, c.xyz, d.xyz, int(d.w), ivec2(int(a.w), int(e.z)), int(c.w), e.xy, vec2(b.w, e.w));
}
