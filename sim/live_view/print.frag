// Light from a print towards the eye, stored as live.frag does.
layout(binding = 0) uniform sampler2D picture;  // share of bare paper
uniform vec4 light_00;                          // irradiance in the corners: right, down
uniform vec4 light_10;
uniform vec4 light_01;
uniform vec4 light_11;
in vec2 at;
layout(location = 0) out vec4 colour;

const int kSide = 4;  // places along each side of the pixel

void main() {
  vec2 across = dFdx(at), down = dFdy(at);
  float paper = 0.0;
  for (int k = 0; k < kSide * kSide; ++k) {
    vec2 o = (vec2(k % kSide, k / kSide) + 0.5) / float(kSide) - 0.5;
    paper += textureGrad(picture, at + o.x * across + o.y * down, across / float(kSide), down / float(kSide)).r;
  }
  // Ink sends back 5 %, paper 80 %.
  float reflected = mix(0.05, 0.80, paper / float(kSide * kSide)) * 0.318309886;
  vec3 light = mix(mix(light_00, light_10, at.x), mix(light_01, light_11, at.x), at.y).rgb;
  colour = vec4(sqrt(0.5 * reflected * light), 1.0);
}
