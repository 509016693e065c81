// Two pictures in one. Row 0 is the top.
#include "luma.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2D first;   // left eye; newest image
layout(binding = 1) uniform sampler2D second;  // right eye; prediction
layout(binding = 0, rgba8) uniform writeonly image2D picture;
uniform int way;     // as PictureMix::Way
uniform vec2 size;   // of the picture, px
uniform int border;  // px
uniform int parity;  // of rows that the first picture gets

// Linear between the four texels around the same place of a picture of any size.
vec4 scaled(sampler2D source, vec2 at) {
  ivec2 last = textureSize(source, 0) - 1;
  vec2 p = (at + 0.5) / size * vec2(last + 1) - 0.5;
  ivec2 base = ivec2(floor(p));
  vec2 f = p - vec2(base);
  ivec2 a = clamp(base, ivec2(0), last), b = clamp(base + 1, ivec2(0), last);
  vec4 above = mix(texelFetch(source, a, 0), texelFetch(source, ivec2(b.x, a.y), 0), f.x);
  vec4 below = mix(texelFetch(source, ivec2(a.x, b.y), 0), texelFetch(source, b, 0), f.x);
  return mix(above, below, f.y);
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, ivec2(size)))) return;
  vec2 at = vec2(pixel);
  vec4 out_colour;
  if (way == 0) {
    out_colour = pixel.x < border ? scaled(first, at) : scaled(second, at);
    if (abs(pixel.x - border) <= 1) out_colour = vec4(1.0, 0.86, 0.45, 1.0);
  } else if (way == 1) {
    out_colour = (pixel.y & 1) == parity ? scaled(first, at) : scaled(second, at);
  } else {
    vec4 left = scaled(first, at), right = scaled(second, at);
    vec2 cyan = way == 2 ? vec2(luma_of(right.rgb)) : right.gb;
    out_colour = vec4(luma_of(left.rgb), cyan, max(left.a, right.a));
  }
  imageStore(picture, pixel, vec4(out_colour.rgb, 1.0));
}
