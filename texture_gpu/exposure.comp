// The new image's brightness at each page that it sees for certain: the mean of a 4x4 grid of
// points on the page. One invocation a page.
#include "camera.glsl"
#include "seen.glsl"
#include "image_taps.glsl"
#include "chart_record.glsl"
#include "atlas.glsl"
#include "asked_page.glsl"
#include "luma.glsl"
layout(local_size_x = 64) in;
layout(binding = 0, std430) writeonly buffer Samples { vec4 samples[]; };  // ExposureSample (exposure.hpp)
const float kWhitest = 0.97, kSaturated = 2.0, kLeast = 0.002;
uniform int camera;

void main() {
  int sample_index = int(gl_GlobalInvocationID.x);
  if (!is_asked(sample_index)) return;
  samples[sample_index] = vec4(-1.0, 0.0, 0.0, 0.0);
  AskedPage page;
  if (!read_page(sample_index, page)) return;
  float highest = 0.0, count = 0.0;
  vec3 sum = vec3(0.0);
  vec2 center = vec2(0.0);
  for (int i = 0; i < 16; ++i) {
    vec3 p_node;
    if (!find_point(page, texel_of_point(i), p_node)) continue;
    vec3 p = node_to_camera(node_poses, camera * node_count + page.chart.node, p_node);
    vec2 pixel;
    if (!is_seen(camera, p, pixel)) continue;
    vec2 uv = (pixel + 0.5) / cameras[camera].size.xy;
    vec3 rgb = min(unscaled(camera == 0 ? textureLod(image0, uv, 0.0) : textureLod(image1, uv, 0.0)), 1.0);
    sum += rgb;
    highest = max(highest, max(rgb.r, max(rgb.g, rgb.b)));
    center += pixel;
    count += 1.0;
  }
  if (count < 12.0) return;  // an edge of the page or of the view
  vec2 half_size = 0.5 * (cameras[camera].size.xy - 1.0);
  vec2 offset = (center / count - half_size) / length(half_size);
  vec3 logs = log(max(sum / count, vec3(kLeast)));
  samples[sample_index] = vec4(luma_of(sum / count) + (highest > kWhitest ? kSaturated : 0.0), dot(offset, offset),
                               logs.r - logs.g, logs.b - logs.g);
}
