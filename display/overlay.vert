// A stroke of an overlay: its two ends go through the lens, and a strip of constant width is drawn between them.
#include "camera.glsl"
layout(std140, binding = 0) uniform Camera { CameraBlock camera; };
layout(binding = 0) uniform samplerBuffer strokes;  // a, along; b, width; colour, opacity; dash, begins, ends
uniform mat4 T_camera_world;
uniform vec4 target;      // width, height, px; 1: its first row is at the top; px that are added all around
out vec2 px;              // along and across the stroke, from its begin
out vec3 p_camera;        // m
flat out vec4 colour;
flat out vec4 shape;      // length and half width, px; dash, m; begins + 2 ends
out float along;          // m

void main() {
  int stroke = 4 * (gl_VertexID / 6), corner = gl_VertexID % 6;
  vec4 a = texelFetch(strokes, stroke), b = texelFetch(strokes, stroke + 1), style = texelFetch(strokes, stroke + 3);
  colour = texelFetch(strokes, stroke + 2);
  bool at_end = corner == 1 || corner == 2 || corner == 4;
  float side = corner == 0 || corner == 1 || corner == 3 ? -1.0 : 1.0;
  vec3 a_camera = (T_camera_world * vec4(a.xyz, 1.0)).xyz, b_camera = (T_camera_world * vec4(b.xyz, 1.0)).xyz;
  vec2 a_px, b_px;
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);  // nowhere
  px = vec2(0.0);
  p_camera = at_end ? b_camera : a_camera;
  along = a.w + (at_end ? distance(a.xyz, b.xyz) : 0.0);
  shape = vec4(0.0);
  bool near = lens_model(camera) != 2 && min(a_camera.z, b_camera.z) < 2.0 * kNear;
  if (near || !project_lens(camera, a_camera, a_px) || !project_lens(camera, b_camera, b_px)) return;
  vec2 scale = target.xy / camera.size.xy;
  a_px = (a_px + 0.5) * scale;
  b_px = (b_px + 0.5) * scale;
  float run = distance(a_px, b_px), reach = 0.5 * b.w + target.w + 1.0;
  if (run > max(target.x, target.y)) return;
  vec2 way = run > 1e-3 ? (b_px - a_px) / run : vec2(1.0, 0.0);
  px = vec2(at_end ? run + reach : -reach, side * reach);
  shape = vec4(run, 0.5 * b.w + target.w, style.x, style.y + 2.0 * style.z);
  vec2 at = a_px + way * px.x + vec2(-way.y, way.x) * px.y;
  vec2 place = 2.0 * at / target.xy - 1.0;
  gl_Position = vec4(place.x, target.z > 0.5 ? place.y : -place.y, 0.0, 1.0);
}
