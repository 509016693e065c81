// For each pixel, as one eye sees it, how far to its left the other sees the same point: see stereogram.hpp.
#include "near.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2DArray depth;  // near / z, 0 where no model is
layout(binding = 0, r32f) uniform writeonly image2D links;
uniform ivec2 size;
uniform vec2 range;   // inverse distance, 1/m: that of nearness 0, and 1 over the way to that of nearness 1
uniform vec2 eyes;    // distance in px; depth of field
uniform vec2 bounds;  // least and largest separation, px
uniform int inverted, hides, smooth_links;
const float kStep = 1.5;    // px of separation between neighbours beyond which they are of two surfaces
const float kBefore = 1.0;  // px by which another surface has to be before the point to hide it

int row;

float at(int x) {
  float q = texelFetch(depth, ivec3(clamp(x, 0, size.x - 1), row, 0), 0).r / kNear;
  float z = clamp((q - range.x) * range.y, 0.0, 1.0);
  z = eyes.y * (inverted != 0 ? 1.0 - z : z);
  return eyes.x * (1.0 - z) / (2.0 - z);
}

// Between two pixels of one surface a mean, else the nearer pixel's.
float between(float x) {
  int first = int(floor(x));
  float a = at(first), b = at(first + 1), t = x - float(first);
  return abs(a - b) < kStep ? mix(a, b, t) : t < 0.5 ? a : b;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, size))) return;
  row = pixel.y;
  float x = float(pixel.x), found = 0.0;
  if (hides == 0) {
    found = at(pixel.x);
  } else {
    // What is nearer has the smaller separation; the larger one for eyes that cross before the picture.
    float way = inverted != 0 ? -1.0 : 1.0;
    vec2 ends = inverted != 0 ? -bounds.yx : bounds;
    // Along one eye's ray, from near to far: at u it is as deep as separations of 2 (x - u).
    float before = 0.0, last = 0.0, d_found = ends.y;
    int steps = int(ceil(bounds.y - bounds.x)) + 1;
    for (int i = 0; i <= steps; ++i) {
      float d = min(ends.x + float(i), ends.y);
      float surface = way * between(x - 0.5 * abs(d));
      if (d < surface && i < steps) {
        before = surface - d;
        last = surface;
        continue;
      }
      float beyond = d - surface;
      // Behind an edge: the surface before it goes on there, as far as anybody knows.
      d_found = i == 0 ? surface : beyond + before > kStep + 1.0 ? last : d - beyond / max(beyond + before, 1e-3);
      break;
    }
    found = abs(d_found);
    // The other eye's ray to the same point.
    float left = x - found;
    for (float d = ends.x; d < d_found - kBefore; d += 1.0) {
      float surface = way * between(left + 0.5 * abs(d));
      if (surface < min(d - 0.01, d_found - kBefore)) {
        found = 0.0;
        break;
      }
    }
  }
  found = smooth_links != 0 ? found : round(found);
  imageStore(links, pixel, vec4(found <= x ? found : 0.0));
}
