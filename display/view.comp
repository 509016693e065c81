// The predicted view: per pixel, lens ray -> triangle -> surface point -> chart -> texels.
#include "camera.glsl"
#include "chart_record.glsl"
#include "atlas.glsl"
uniform float gain;
#define BRIGHTEST (1.0 / gain)
#include "lookup.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(std140, binding = 0) uniform Camera { CameraBlock camera; };
layout(binding = 0) uniform samplerBuffer node_poses;    // T_node_camera
layout(binding = 1) uniform usampler2DArray surfaces;    // triangle + 1
layout(binding = 2) uniform samplerBuffer triangles;
layout(binding = 3) uniform samplerBuffer patches;
layout(binding = 4) uniform sampler2D rays;
layout(binding = 0, rgba8) uniform writeonly image2D picture;

// A pixel counts as seen when at least this share of its filter weight lies on seen texels.
const float kSeenShare = 0.25;

bool ray_through(ivec2 pixel, out vec3 ray) {
  if (lens_model(camera) == 0) {
    ray = vec3((vec2(pixel) - camera.focal.zw) / camera.focal.xy, 1.0);
    return true;
  }
  vec4 r = texelFetch(rays, pixel, 0);
  ray = r.xyz;
  return r.w > 0.5;
}

vec4 shade(vec3 ray) {
  vec3 place;
  float inverse_z;
  if (!project_face(camera, ray, place, inverse_z)) return vec4(0.0);
  uint surface = texelFetch(surfaces, ivec3(ivec2(floor(place.xy + 0.5)), int(place.z)), 0).r;
  if (surface == 0u) return vec4(0.0);
  vec4 plane = texelFetch(triangles, 2 * int(surface - 1u));
  vec4 ids = texelFetch(triangles, 2 * int(surface - 1u) + 1);
  int node = int(ids.y);

  // The ray in the node's frame meets the triangle's plane.
  vec3 d = rotate_to_camera(node_poses, node, ray);
  vec3 o = vec3(texelFetch(node_poses, 3 * node).w, texelFetch(node_poses, 3 * node + 1).w, texelFetch(node_poses, 3 * node + 2).w);
  float facing = dot(plane.xyz, d);
  float t = (plane.w - dot(plane.xyz, o)) / (abs(facing) > 1e-9 ? facing : 1e-9);
  vec3 p = o + t * d;

  int patch_index = 4 * int(ids.x);
  vec4 a = texelFetch(patches, patch_index), b = texelFetch(patches, patch_index + 1),
       c = texelFetch(patches, patch_index + 2), e = texelFetch(patches, patch_index + 3);
  vec2 uv = vec2(dot(p - a.xyz, b.xyz), dot(p - a.xyz, c.xyz));
  ivec2 cells = ivec2(int(a.w), int(b.w));
  ivec2 cell = clamp(ivec2(floor(uv / e.xy)), ivec2(0), cells - 1);
  int chart_index = int(c.w) + cell.y * cells.x + cell.x;
  ChartRecord chart = read_chart(published_charts, chart_index);
  vec4 fallback = vec4(0.0);
  if (chart.density.x > 0.0) {
    vec2 texel = (uv - chart.uv0) * chart.density;
    // Where even the less crowded axis has more texels than pixels, coarser levels hold the means.
    vec3 sight = normalize(d);
    vec3 du = chart.eu - sight * dot(sight, chart.eu), dv = chart.ev - sight * dot(sight, chart.ev);
    float pixels_per_texel = max(camera.focal.x, camera.focal.y) * max(length(du), length(dv)) / (abs(t) * length(ray));
    float lod = -log2(max(pixels_per_texel, 1e-6));
    int level = clamp(int(floor(lod + 0.15)), 0, 4);
    Taps taps;
    if (level == 0)
      taps = gather_sharp_taps(chart, texel);
    else
      taps = gather_taps(chart, texel, level);
    if (taps.seen.a >= kSeenShare) return vec4(min(taps.seen.rgb / taps.seen.a * gain, vec3(1.0)), 1.0);
    if (taps.seen.a + taps.filled.a > 0.0)
      return vec4(min((taps.seen.rgb + taps.filled.rgb) / (taps.seen.a + taps.filled.a) * gain, vec3(1.0)), 128.0 / 255.0);
    fallback = coarse_colour(chart, chart_index, texel);
  } else {
    fallback = texelFetch(published_means, chart_index);
  }
  return fallback.a > 0.0 ? vec4(min(fallback.rgb * gain, vec3(1.0)), 128.0 / 255.0) : vec4(vec3(0.0), 64.0 / 255.0);
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, ivec2(camera.size.xy)))) return;
  vec3 ray;
  imageStore(picture, pixel, ray_through(pixel, ray) ? shade(ray) : vec4(0.0));
}
