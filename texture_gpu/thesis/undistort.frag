// The camera image as a pinhole would have seen it.
// Define UNSEEN: 0 colour; 1 only depth, nearest (1) where the camera sees nothing.
#include "camera.glsl"
layout(std140, binding = 0) uniform Camera { CameraBlock camera; };
layout(binding = 0) uniform sampler2D image;
layout(location = 0) out vec4 colour;

void main() {
  vec3 ray = vec3((gl_FragCoord.xy - 0.5 - camera.face.zw) / camera.face.xy, 1.0);
  vec2 pixel;
  bool seen = project_lens(camera, ray, pixel) && all(greaterThan(pixel, vec2(-0.5))) &&
              all(lessThan(pixel, camera.size.xy - 0.5));
#if UNSEEN
  if (seen) discard;
  gl_FragDepth = 1.0;
#else
  colour = vec4(seen ? textureLod(image, (pixel + 0.5) / camera.size.xy, 0.0).rgb : vec3(0.0), 31.0 / 32.0);
#endif
}
