// A view painted by how far each pixel may be off.
#include "classes.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2D shown;
layout(binding = 1) uniform sampler2D doubt;  // as TrustPass has it
layout(binding = 0, rgba8) uniform writeonly image2D picture;

const float kSmall = 10.5 / 255.0, kLarge = 30.5 / 255.0, kUnknown = 254.5 / 255.0;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(picture)))) return;
  vec4 colour = texelFetch(shown, pixel, 0);
  float off = texelFetch(doubt, pixel, 0).r;
  int level = off < kSmall ? 0 : off < kLarge ? 1 : off < kUnknown ? 2 : 3;
  float grey = dot(colour.rgb, vec3(0.299, 0.587, 0.114));
  imageStore(picture, pixel, colour.a > 0.0 ? vec4(class_colour(pixel, level, grey), colour.a) : colour);
}
