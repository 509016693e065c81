// Depth of a face as 1/z, and its slope. Needs camera.glsl.
layout(binding = 0) uniform sampler2DArray depth;
uniform ivec2 face_size;

// 0 outside: repeating the border's depth there would bend a plane. Software renderers fetch by
// integer coordinates far more slowly than they sample the nearest texel.
float inverse_z(ivec2 at, int layer) {
  ivec2 inside = clamp(at, ivec2(0), face_size - 1);
  float d = textureLod(depth, vec3((vec2(at) + 0.5) / vec2(face_size), layer), 0.0).r;
  return inside == at ? d / kNear : 0.0;
}

// Slope of 1/z along `step` at p, from the side on which the surface bends less.
float slope(ivec2 p, ivec2 step, int layer, float center) {
  float a1 = inverse_z(p - step, layer), a2 = inverse_z(p - 2 * step, layer);
  float b1 = inverse_z(p + step, layer), b2 = inverse_z(p + 2 * step, layer);
  float bend_a = a1 > 0.0 && a2 > 0.0 ? abs(a2 - 2.0 * a1 + center) : 1e30;
  float bend_b = b1 > 0.0 && b2 > 0.0 ? abs(b2 - 2.0 * b1 + center) : 1e30;
  if (min(bend_a, bend_b) > 1e29) return 0.0;
  return bend_a < bend_b ? center - a1 : b1 - center;
}
