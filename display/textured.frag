// The polygon's texture, or nothing.
#include "view_alpha.glsl"
layout(binding = 0) uniform sampler2D normalised;
uniform float hole_alpha;
in vec2 st;
layout(location = 0) out vec4 colour;

void main() {
  vec4 texel = texture(normalised, st);
  colour = texel.a > 0.5 ? vec4(texel.rgb, 1.0) : vec4(is_coloured(hole_alpha) ? texel.rgb : vec3(0.0), hole_alpha);
}
