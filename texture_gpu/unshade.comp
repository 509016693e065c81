// Takes shadows of moving parts out of an image: each pixel as bright as it would be without. What would be brighter
// than white is scaled, by its alpha. Over the blocks that shadow.comp listed.
#define INVOCATIONS_PER_ITEM 16
#define WORDS_PER_ITEM 2
layout(local_size_x = 64) in;  // four blocks
#include "work_item.glsl"
layout(binding = 0) uniform sampler2D light;
layout(binding = 0, rgba8) uniform image2D image;
const float kBrightest = 0.95;  // below what counts as white in extract.comp

void main() {
  uint item;
  if (!next_work(item)) return;
  ivec2 pixel = ivec2(item & 0xffffu, item >> 16) + ivec2(gl_LocalInvocationIndex & 3u, (gl_LocalInvocationIndex >> 2) & 3u);
  if (any(greaterThanEqual(pixel, textureSize(light, 0)))) return;
  vec3 factor = texelFetch(light, pixel, 0).rgb;
  if (factor == vec3(1.0)) return;
  vec3 colour = imageLoad(image, pixel).rgb / factor;
  float scale = min(1.0, kBrightest / max(max(colour.r, colour.g), max(colour.b, 1e-3)));
  imageStore(image, pixel, vec4(colour * scale, scale));
}
