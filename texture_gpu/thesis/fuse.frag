// The alpha test of section 4.4.2: only valid texels are drawn.
layout(binding = 0) uniform sampler2D fresh;
layout(location = 0) out vec4 colour;

void main() {
  colour = texelFetch(fresh, ivec2(gl_FragCoord.xy), 0);
  if (colour.a < 0.5) discard;
}
