// How well the new image agrees with the textures, page by page: how much it differs from them, beside how much it
// changes from pixel to pixel. One invocation a page; a 4x4 grid of its points, as in exposure.comp.
#include "camera.glsl"
#include "seen.glsl"
#include "image_taps.glsl"
#include "chart_record.glsl"
#include "atlas.glsl"
#include "asked_page.glsl"
#include "luma.glsl"
layout(local_size_x = 64) in;
layout(binding = 11) uniform usamplerBuffer published_table;  // as in lookup.glsl
layout(binding = 12) uniform samplerBuffer published_charts;
layout(binding = 13) uniform sampler2DArray published_colours;
layout(binding = 0, std430) writeonly buffer Samples { vec2 samples[]; };  // AgreementSample (sharpness.hpp)
const float kWhitest = 0.97;

float image_luma(vec2 pixel) {
  return luma_of(unscaled(textureLod(image0, (pixel + 0.5) / cameras[0].size.xy, 0.0)));
}

// Squared gradient, by the differences to the pixels on either side: across both at once, what is a pixel wide would not count.
float image_gradient2(vec2 pixel) {
  float here = image_luma(pixel);
  vec2 x = here - vec2(image_luma(pixel - vec2(1.0, 0.0)), image_luma(pixel + vec2(1.0, 0.0)));
  vec2 y = here - vec2(image_luma(pixel - vec2(0.0, 1.0)), image_luma(pixel + vec2(0.0, 1.0)));
  return 0.5 * (dot(x, x) + dot(y, y));
}

// False where the published textures have the page at another resolution, or not at all.
bool find_colours(AskedPage page, out ivec3 origin) {
  ChartRecord chart = read_chart(published_charts, page.chart_index);
  if (chart.density != page.chart.density || any(greaterThanEqual(page.at, chart.pages))) return false;
  uint slot = texelFetch(published_table, chart.first_page + page.at.y * chart.pages.x + page.at.x).r;
  if (slot == kNoSlot) return false;
  origin = slot_origin(slot, 0);
  return true;
}

// Of values x in the image and y in the textures: mean squared difference, means and contrast evened out, as exposure and
// shadows change those. `sums`: of x, y, xx, yy, xy.
float difference2(float sum_x, float sum_y, float xx, float yy, float xy, float count) {
  float scale = sum_x / max(sum_y, 1e-6);
  float var_x = xx - sum_x * sum_x / count, var_y = yy - sum_y * sum_y / count, cov = xy - sum_x * sum_y / count;
  return max(var_x + scale * scale * var_y - 2.0 * scale * cov, 0.0) / (count - 1.0);
}

void main() {
  int sample_index = int(gl_GlobalInvocationID.x);
  if (!is_asked(sample_index)) return;
  samples[sample_index] = vec2(-1.0, 0.0);
  AskedPage page;
  if (!read_page(sample_index, page)) return;
  ivec3 colours_at;
  if (!find_colours(page, colours_at)) return;
  float x = 0.0, y = 0.0, xx = 0.0, yy = 0.0, xy = 0.0, gradient2 = 0.0, count = 0.0;
  for (int i = 0; i < 16; ++i) {
    ivec2 texel = texel_of_point(i);
    vec4 known = unpack_texel(texelFetch(published_colours, colours_at + ivec3(texel, 0), 0));
    vec3 p_node;
    if (!find_point(page, texel, p_node) || known.a < kSeen) continue;
    vec3 p = node_to_camera(node_poses, page.chart.node, p_node);
    vec2 pixel;
    if (!is_seen(0, p, pixel)) continue;
    vec2 size = cameras[0].size.xy;
    vec4 scaled = sample_sharply(image0, pixel, size, 1.0);  // as extract.comp does
    if (max(scaled.r, max(scaled.g, scaled.b)) > kWhitest) continue;
    float a = luma_of(unscaled(scaled)), b = luma_of(known.rgb);
    x += a;
    y += b;
    xx += a * a;
    yy += b * b;
    xy += a * b;
    gradient2 += image_gradient2(pixel);
    count += 1.0;
  }
  if (count < 12.0) return;  // an edge of the page or of the view
  samples[sample_index] = vec2(difference2(x, y, xx, yy, xy, count), gradient2 / count);
}
