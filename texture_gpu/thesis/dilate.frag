// One texel of dilation of the invalid areas (eq. 5.5), over the rhomb of figure 5.10.
layout(binding = 0) uniform sampler2D mask;
uniform ivec2 size;
layout(location = 0) out vec4 alpha;

float at(ivec2 texel) {
  return texelFetch(mask, clamp(texel, ivec2(0), size - 1), 0).a;
}

void main() {
  ivec2 p = ivec2(gl_FragCoord.xy);
  float own = at(p);
  float sum = at(p + ivec2(1, 0)) + at(p - ivec2(1, 0)) + at(p + ivec2(0, 1)) + at(p - ivec2(0, 1));
  alpha = vec4(sum > 3.5 ? own : 0.0);
}
