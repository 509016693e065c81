// How bright the new image shows each witness of the lamp (lamp/witnesses.hpp): the mean of five points within a
// centimetre. One invocation a witness.
#include "camera.glsl"
#include "seen.glsl"
#include "image_taps.glsl"
#include "vignetting.glsl"
layout(local_size_x = 64) in;
layout(binding = 7) uniform samplerBuffer witnesses;  // point, normal; world
layout(binding = 0, std430) writeonly buffer Brightness { vec4 brightness[]; };
uniform int witness_count;
uniform mat4 T_camera_world;
const float kReach = 0.006;  // metres
const float kWhitest = 0.97;

void main() {
  int index = int(gl_GlobalInvocationID.x);
  if (index >= witness_count) return;
  vec4 value = vec4(-1.0);
  vec3 p = (T_camera_world * vec4(texelFetch(witnesses, 2 * index).xyz, 1.0)).xyz;
  vec3 n = mat3(T_camera_world) * texelFetch(witnesses, 2 * index + 1).xyz;
  vec3 u = normalize(abs(n.x) < 0.7 ? cross(n, vec3(1.0, 0.0, 0.0)) : cross(n, vec3(0.0, 1.0, 0.0)));
  mat2 axes = footprint(0, p, kReach * u, kReach * cross(n, u));
  vec2 pixel, size = cameras[0].size.xy;
  if (is_seen(0, p, pixel)) {
    vec3 sum = vec3(0.0);
    float highest = 0.0;
    for (int i = 0; i < 5; ++i) {
      vec2 o = vec2(float(i == 1) - float(i == 2), float(i == 3) - float(i == 4));
      vec3 rgb = textureLod(image0, (pixel + axes * o + 0.5) / size, 0.0).rgb;
      sum += rgb;
      highest = max(highest, max(rgb.r, max(rgb.g, rgb.b)));
    }
    if (highest < kWhitest) value.rgb = sum / 5.0 * without_vignetting(cameras[0].tone, pixel, size);
  }
  brightness[index] = value;
}
