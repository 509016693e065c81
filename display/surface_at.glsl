// Which point of which chart a ray of a view meets. Needs camera.glsl, chart_record.glsl, lookup.glsl; what PredictedView
// has bound when it draws.
layout(std140, binding = 0) uniform Camera { CameraBlock camera; };
layout(binding = 0) uniform samplerBuffer node_poses;  // T_node_camera
layout(binding = 1) uniform usampler2DArray surfaces;  // triangle + 1
layout(binding = 2) uniform samplerBuffer triangles;
layout(binding = 3) uniform samplerBuffer patches;
#include "seen_plane.glsl"
#include "view_ray.glsl"

// Triangle + 1; 0: no model there. `at`: where on the faces.
uint surface_of(vec3 ray, out ivec3 at) {
  vec3 place;
  float inverse_z;
  if (!project_face(camera, ray, place, inverse_z)) return 0u;
  at = ivec3(ivec2(floor(place.xy + 0.5)), int(place.z));
  return texelFetch(surfaces, at, 0).r;
}

struct SurfaceAt {
  ChartRecord chart;
  vec2 texel;              // of its level 0
  float pixels_per_texel;  // of the view
};

SurfaceAt surface_at(vec3 ray, ivec3 at_face, uint surface) {
  vec4 plane = seen_plane(at_face, surface);
  vec4 ids = texelFetch(triangles, 2 * int(surface - 1u) + 1);
  int node = int(ids.y);
  vec3 d = rotate_to_camera(node_poses, node, ray);
  vec3 o = vec3(texelFetch(node_poses, 3 * node).w, texelFetch(node_poses, 3 * node + 1).w, texelFetch(node_poses, 3 * node + 2).w);
  float facing = dot(plane.xyz, d);
  float t = (plane.w - dot(plane.xyz, o)) / (abs(facing) > 1e-9 ? facing : 1e-9);
  vec3 p = o + t * d;
  int at = 4 * int(ids.x);
  vec4 a = texelFetch(patches, at), b = texelFetch(patches, at + 1), c = texelFetch(patches, at + 2), e = texelFetch(patches, at + 3);
  vec2 uv = vec2(dot(p - a.xyz, b.xyz), dot(p - a.xyz, c.xyz));
  ivec2 cells = ivec2(int(a.w), int(b.w));
  ivec2 cell = clamp(ivec2(floor(uv / e.xy)), ivec2(0), cells - 1);
  SurfaceAt found;
  found.chart = read_chart(published_charts, int(c.w) + cell.y * cells.x + cell.x);
  found.texel = (uv - found.chart.uv0) * found.chart.density;
  found.pixels_per_texel = camera.focal.x * length(found.chart.eu) / max(abs(t) * length(ray), 1e-9);
  return found;
}
