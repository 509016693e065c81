// A pixel's ray in the source, and the surface that it meets there: see depth_warp.hpp.
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

vec3 ray_of(vec2 pixel) {
  return vec3((pixel - target_lens.zw) / target_lens.xy, 1.0);
}

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
