// A view painted by the class of each pixel's kind of doubt: how often such pixels are wrong (doubt_paint.hpp).
#include "classes.glsl"
#include "luma.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2D shown;
layout(binding = 1) uniform sampler2D doubt;  // as TrustPass has it
layout(binding = 0, rgba8) uniform writeonly image2D picture;
uniform uint classes[16];  // by doubt, two bits each

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(picture)))) return;
  vec4 colour = texelFetch(shown, pixel, 0);
  uint kind = uint(round(255.0 * texelFetch(doubt, pixel, 0).r));
  int level = int(classes[kind >> 4] >> (2u * (kind & 15u)) & 3u);
  float grey = luma_of(colour.rgb);
  imageStore(picture, pixel, colour.a > 0.0 ? vec4(class_colour(pixel, level, grey), colour.a) : colour);
}
