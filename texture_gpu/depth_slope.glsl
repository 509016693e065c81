// Depth of a face as 1/z, its slope, and where its surfaces end. Needs camera.glsl.
layout(binding = 0) uniform sampler2DArray depth;
uniform ivec2 face_size;
uniform float depth_tolerance;  // metres

// Is what is seen at 1/z = near in front of 1/z = far by more than the tolerance?
bool steps_back(float near, float far) {
  return near - far > depth_tolerance * near * far;
}

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

// Is a pixel q in front of what lies beyond it? 1/z of a row: of the pixel before q, q itself, and r, r2 beyond.
//
//   q ____            r, r2: the surface beyond; its plane, extended to q, is behind q by more than
//         |           the tolerance
//         |  r r2
//         |__.__.___
//
// Off the plane, not just nearer: 1/z is linear in the picture of a plane, so that a plane seen at
// a grazing angle has no discontinuity, and a crease has none.
bool ends_between(float before, float center, float r, float r2) {
  // Where nothing tells the slope beyond, the near surface's own goes on.
  float near = r2 > 0.0 || before <= 0.0 ? center : 2.0 * center - before;
  float far = r2 > 0.0 ? max(2.0 * r - r2, 0.0) : r;  // a plane beyond its horizon is behind all
  return r > 0.0 && r < center && steps_back(near, far);
}

// The same of a place, along `step`.
bool ends(ivec2 q, float center, ivec2 step, int layer) {
  return ends_between(inverse_z(q - step, layer), center, inverse_z(q + step, layer), inverse_z(q + 2 * step, layer));
}

// Towards +x, +y, -x, -y.
bvec4 ends_around(ivec2 q, float center, int layer) {
  if (center <= 0.0) return bvec4(false);
  return bvec4(ends(q, center, ivec2(1, 0), layer), ends(q, center, ivec2(0, 1), layer),
               ends(q, center, ivec2(-1, 0), layer), ends(q, center, ivec2(0, -1), layer));
}
