// The ray that a view's pixel looks along, not of unit length; false where the lens has none. Needs camera.glsl and `camera`.
layout(binding = 4) uniform sampler2D rays;

bool ray_through(ivec2 pixel, out vec3 ray) {
  if (lens_model(camera) == 0) {
    ray = vec3((vec2(pixel) - camera.focal.zw) / camera.focal.xy, 1.0);
    return true;
  }
  vec4 r = texelFetch(rays, pixel, 0);
  ray = r.xyz;
  return r.w > 0.5;
}
