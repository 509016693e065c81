// A camera's image as another lens shows it. Row 0 is the top. Define: DISTORTED 1 where that lens has a distortion.
#include "camera.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(std140, binding = 0) uniform Camera { CameraBlock camera; };
layout(binding = 0) uniform sampler2D image;
layout(binding = 1) uniform sampler2D rays;  // of the eye's lens
layout(binding = 0, rgba8) uniform writeonly image2D picture;
uniform vec4 eye;  // fx fy cx cy, px

// Linear between the four texels around a place of the image, px of the lens.
vec3 colour_at(vec2 at) {
  ivec2 last = textureSize(image, 0) - 1;
  vec2 p = (at + 0.5) / camera.size.xy * vec2(last + 1) - 0.5;
  ivec2 base = ivec2(floor(p));
  vec2 f = p - vec2(base);
  ivec2 a = clamp(base, ivec2(0), last), b = clamp(base + 1, ivec2(0), last);
  vec3 above = mix(texelFetch(image, a, 0).rgb, texelFetch(image, ivec2(b.x, a.y), 0).rgb, f.x);
  vec3 below = mix(texelFetch(image, ivec2(a.x, b.y), 0).rgb, texelFetch(image, b, 0).rgb, f.x);
  return mix(above, below, f.y);
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(picture)))) return;
#if DISTORTED
  vec4 ray = texelFetch(rays, pixel, 0);  // 0: the eye's lens sees nothing there
#else
  vec4 ray = vec4((vec2(pixel) - eye.zw) / eye.xy, 1.0, 1.0);
#endif
  vec2 at;
  bool seen = ray.w > 0.5 && project_lens(camera, ray.xyz, at) && all(greaterThanEqual(at, vec2(-0.5))) &&
              all(lessThanEqual(at, camera.size.xy - 0.5));
  imageStore(picture, pixel, vec4(seen ? colour_at(at) : vec3(0.0), 1.0));
}
