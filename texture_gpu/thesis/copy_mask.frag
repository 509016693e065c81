layout(binding = 0) uniform sampler2D mask;
layout(location = 0) out vec4 colour;

void main() {
  colour = vec4(texelFetch(mask, ivec2(gl_FragCoord.xy), 0).a);
}
