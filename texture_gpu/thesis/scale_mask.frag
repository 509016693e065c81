// Draws the mask at half (STEP 2.0) or double (STEP 0.5) its size with bilinear interpolation. What
// any invalid texel took part in does not exceed LIMIT (eqs. 5.1, 5.2) and becomes invalid.
layout(binding = 0) uniform sampler2D mask;
uniform ivec2 source;  // texels of the mask in use
layout(location = 0) out vec4 alpha;

void main() {
  vec2 at = clamp(gl_FragCoord.xy * STEP, vec2(0.5), vec2(source) - 0.5);
  float a = textureLod(mask, at / vec2(textureSize(mask, 0)), 0.0).a;
  alpha = vec4(a > LIMIT + 0.004 ? a : 0.0);
}
