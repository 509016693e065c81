// The new image's brightness at each page that it sees for certain: the mean of a 4x4 grid of
// points on the page. One invocation a page.
#include "camera.glsl"
#include "seen.glsl"
#include "image_taps.glsl"
#include "chart_record.glsl"
#include "atlas.glsl"
layout(local_size_x = 64) in;
layout(binding = 7) uniform usamplerBuffer pages;  // as in cull.comp
layout(binding = 8) uniform samplerBuffer charts;
layout(binding = 9) uniform usampler2DArray heights;
layout(binding = 0, std430) writeonly buffer Samples { vec2 samples[]; };  // ExposureSample (exposure.hpp)
const float kWhitest = 0.97, kSaturated = 2.0;
uniform int page_count;
uniform int camera;
uniform int first_page;  // the pages first_page, first_page + stride, ... are asked about
uniform int stride;

void main() {
  int sample_index = int(gl_GlobalInvocationID.x);
  int index = first_page + sample_index * stride;
  if (index >= page_count) return;
  samples[sample_index] = vec2(-1.0, 0.0);
  uvec4 page = texelFetch(pages, 3 * index);
  if (page.z == kNoSlot) return;
  ChartRecord chart = read_chart(charts, int(page.x));
  ivec3 origin = slot_origin(page.z, 0);
  ivec2 corner = 16 * ivec2(page.y & 0xffffu, page.y >> 16);
  float sum = 0.0, highest = 0.0, count = 0.0;
  vec2 center = vec2(0.0);
  for (int i = 0; i < 16; ++i) {
    ivec2 at = ivec2(i & 3, i >> 2) * 4 + 2;
    uint raw = texelFetch(heights, origin + ivec3(at, 0), 0).r;
    if (raw == 0u) continue;
    vec2 t = vec2(corner + at);
    vec3 p_node = chart.origin + t.x * chart.eu + t.y * chart.ev + (float(raw & 0x7fffu) - 1.0) * chart.eh;
    vec3 p = node_to_camera(node_poses, camera * node_count + chart.node, p_node);
    vec2 pixel;
    if (!is_seen(camera, p, pixel)) continue;
    vec2 uv = (pixel + 0.5) / cameras[camera].size.xy;
    vec3 rgb = min(unscaled(camera == 0 ? textureLod(image0, uv, 0.0) : textureLod(image1, uv, 0.0)), 1.0);
    float luma = dot(rgb, vec3(0.299, 0.587, 0.114));
    sum += luma;
    highest = max(highest, max(rgb.r, max(rgb.g, rgb.b)));
    center += pixel;
    count += 1.0;
  }
  if (count < 12.0) return;  // an edge of the page or of the view
  vec2 half_size = 0.5 * (cameras[camera].size.xy - 1.0);
  vec2 offset = (center / count - half_size) / length(half_size);
  samples[sample_index] = vec2(sum / count + (highest > kWhitest ? kSaturated : 0.0), dot(offset, offset));
}
