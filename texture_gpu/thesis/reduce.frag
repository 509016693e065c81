// One level of the pyramid: the mean of the valid ones of four texels (eqs. 5.6, 5.7), or of two
// where only one direction still shrinks (eqs. 5.8, 5.9).
layout(binding = 0) uniform sampler2D finer;
uniform ivec2 taps;  // texels that become one, along x and y: 1 or 2
layout(location = 0) out vec4 colour;

void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * taps;
  vec4 sum = vec4(0.0);
  for (int j = 0; j < taps.y; ++j)
    for (int i = 0; i < taps.x; ++i) {
      vec4 texel = texelFetch(finer, first + ivec2(i, j), 0);
      sum += vec4(texel.rgb, 1.0) * (texel.a > 0.5 ? 1.0 : 0.0);
    }
  colour = sum.a > 0.0 ? vec4(sum.rgb / sum.a, 1.0) : vec4(0.0);
}
