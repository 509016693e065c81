// A pixel's ray in the source, and the surface that it meets there: see depth_warp.hpp.
// Define: DISTORTED 1 where the target's lens has a distortion.
uniform vec4 source_lens, target_lens;  // fx fy cx cy, px
uniform ivec2 source_size, target_size;
uniform vec4 r0, r1, r2;  // T_source_target: rows of its rotation, and its translation
uniform vec4 back;        // third row of the inverse's rotation; its product with the translation

vec3 base, along;  // of the ray: source = base + along * inverse target depth
vec4 back_row;

void aim(vec3 ray, vec4 a, vec4 b, vec4 c, vec4 d) {
  base = vec3(dot(a.xyz, ray), dot(b.xyz, ray), dot(c.xyz, ray));
  along = vec3(a.w, b.w, c.w);
  back_row = d;
}

#if DISTORTED
layout(binding = 7) uniform sampler2D target_rays;  // linear: unit directions and 1; 0 where the lens sees nothing
const float kAhead = 0.08;  // of a direction's z: beyond 85 degrees from straight ahead nothing is shown

vec4 direction_of(vec2 pixel) {
  return textureLod(target_rays, (pixel + 0.5) / vec2(target_size), 0.0);
}

bool sees(vec2 pixel) {
  vec4 direction = direction_of(pixel);
  return direction.a > 0.999 && direction.z > kAhead;
}

vec3 ray_of(vec2 pixel) {
  vec3 direction = direction_of(pixel).xyz;
  return direction / max(direction.z, kAhead);
}
#else
bool sees(vec2 pixel) {
  return true;
}

vec3 ray_of(vec2 pixel) {
  return vec3((pixel - target_lens.zw) / target_lens.xy, 1.0);
}
#endif

// Where the source shows what is at inverse target depth w.
vec2 place(float w) {
  vec3 p = base + along * w;
  return source_lens.xy * p.xy / max(p.z, 1e-6) + source_lens.zw;
}

// Inverse target depth of the surface that the source shows at a pixel of inverse depth q.
float surface(vec2 at, float q) {
  vec3 ray = vec3((at - source_lens.zw) / source_lens.xy, 1.0);
  return q / max(dot(back_row.xyz, ray) - q * back_row.w, 1e-6);
}

ivec2 nearest_pixel(vec2 at) {
  return clamp(ivec2(floor(at + 0.5)), ivec2(0), source_size - 1);
}
