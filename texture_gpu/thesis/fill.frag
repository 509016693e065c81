// One pass of hole filling. Only texels that turn from invalid to valid are drawn, so an occlusion
// query around the drawing counts them; the thesis reaches the same with depth offsets.
//
//   stage 1 (1): the eight neighbours      2 2 2 2 2
//   stage 2 (2): the ring around them      2 1 1 1 2
//                                          2 1 . 1 2
//                                          2 1 1 1 2
//                                          2 2 2 2 2
layout(binding = 0) uniform sampler2D previous;
uniform ivec2 size;
layout(location = 0) out vec4 colour;

vec4 ring(ivec2 p, int radius) {
  vec4 sum = vec4(0.0);
  for (int j = -radius; j <= radius; ++j)
    for (int i = -radius; i <= radius; ++i) {
      if (max(abs(i), abs(j)) != radius) continue;
      ivec2 q = p + ivec2(i, j);
      if (any(lessThan(q, ivec2(0))) || any(greaterThanEqual(q, size))) continue;
      vec4 texel = texelFetch(previous, q, 0);
      sum += vec4(texel.rgb, 1.0) * (texel.a > 0.5 ? 1.0 : 0.0);
    }
  return sum;
}

void main() {
  ivec2 p = ivec2(gl_FragCoord.xy);
  if (texelFetch(previous, p, 0).a > 0.5) discard;
  vec4 sum = ring(p, 1);
  if (sum.a == 0.0) discard;  // eq. 5.26
#if TWO_STAGES
  sum += ring(p, 2);  // eq. 5.29
#endif
  colour = vec4(sum.rgb / sum.a, 1.0);
}
