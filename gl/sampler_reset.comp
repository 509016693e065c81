// Samples the nearest texels of one texture in each place where another program may have buffers, and does nothing with
// them (sampler_reset.hpp).
layout(local_size_x = 1) in;
uniform sampler2D places[16];
layout(binding = 0, std430) buffer Nowhere { vec4 nothing; };

void main() {
  vec4 sum = vec4(0.0);
  for (int i = 0; i < 16; ++i) sum += textureLod(places[i], vec2(0.5), 0.0);
  if (sum.r > 16.0) nothing = sum;  // never
}
