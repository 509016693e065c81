// Paints a drawn view by what is known of its textures, in place. Classes differ in hatching, not in colour alone.
#include "camera.glsl"
#include "chart_record.glsl"
#include "atlas.glsl"
#define BRIGHTEST 65504.0
#include "lookup.glsl"
#include "surface_at.glsl"
#include "classes.glsl"
#include "luma.glsl"
#include "view_alpha.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 10) uniform samplerBuffer page_ages;  // s, when the newest image was taken; negative: never seen
layout(binding = 0, rgba8) uniform image2D picture;
uniform int paint;    // as ViewPaint
uniform float since;  // s from the newest image of the ages to the instant shown

// 0 .. 3
int age_class(SurfaceAt at, bool from_image) {
  if (!from_image && seen_colour(at.chart, at.texel, 0).a < kSeen) return 3;  // of a page that was seen in part
  ivec2 page = ivec2(floor(at.texel)) >> 4;
  page = clamp(page, ivec2(0), at.chart.pages - 1);
  float age = texelFetch(page_ages, at.chart.first_page + page.y * at.chart.pages.x + page.x).r;
  return age < 0.0 ? 3 : age + since < 1.0 ? 0 : age + since < 5.0 ? 1 : 2;
}

int confidence_class(SurfaceAt at, bool from_image) {
  vec4 seen = seen_colour(at.chart, at.texel, 0);
  if (seen.a < kSeen) return from_image ? 0 : 3;  // the newest image shows it about as finely as the view
  float image_px_per_texel = exp2((seen.a - kLeastSeen) / (kStepsPerDoubling * kStep) - 8.0);
  float share = image_px_per_texel / max(at.pixels_per_texel, 1e-6);  // image pixels for a pixel of the view
  return share > 0.7 ? 0 : share > 0.25 ? 1 : 2;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, ivec2(camera.size.xy)))) return;
  vec3 ray;
  if (!ray_through(pixel, ray)) return;
  ivec3 place, beside;
  uint surface = surface_of(ray, place);
  vec4 shown = imageLoad(picture, pixel);
  float grey = luma_of(shown.rgb);
  if (paint == 1) {
    vec3 right, below;
    bool border = ray_through(pixel + ivec2(1, 0), right) && surface_of(right, beside) != surface;
    border = border || (ray_through(pixel + ivec2(0, 1), below) && surface_of(below, beside) != surface);
    imageStore(picture, pixel, vec4(border ? vec3(0.55, 1.0, 0.65) : vec3(0.3 * grey), shown.a));
    return;
  }
  if (surface == 0u) return;
  SurfaceAt at = surface_at(ray, place, surface);
  bool from_image = is_from_image(shown.a);
  int level = at.chart.density.x <= 0.0 ? 3 : paint == 2 ? age_class(at, from_image) : confidence_class(at, from_image);
  imageStore(picture, pixel, vec4(class_colour(pixel, level, grey), shown.a));
}
