// The next finer level, enlarged with bilinear interpolation.
layout(binding = 0) uniform sampler2D coarser;
uniform ivec2 source;  // texels in use
uniform vec2 scale;
layout(location = 0) out vec4 colour;

void main() {
  vec2 at = clamp(gl_FragCoord.xy * scale, vec2(0.5), vec2(source) - 0.5);
  colour = vec4(textureLod(coarser, at / vec2(textureSize(coarser, 0)), 0.0).rgb, 1.0);
}
