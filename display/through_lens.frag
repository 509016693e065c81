// A picture plane as the lens would show it.
#include "camera.glsl"
layout(std140, binding = 0) uniform Camera { CameraBlock camera; };
layout(binding = 0) uniform sampler2D plane;
layout(binding = 4) uniform sampler2D rays;
layout(location = 0) out vec4 colour;

void main() {
  vec4 ray = texelFetch(rays, ivec2(gl_FragCoord.xy), 0);
  vec3 place;
  float inverse_z;
  bool seen = ray.w > 0.5 && project_face(camera, ray.xyz, place, inverse_z);
  vec2 at = (place.xy + 0.5) / camera.size.zw;
  float kind = texelFetch(plane, clamp(ivec2(floor(place.xy + 0.5)), ivec2(0), ivec2(camera.size.zw) - 1), 0).a;
  colour = seen ? vec4(textureLod(plane, at, 0.0).rgb, kind) : vec4(0.0);
}
