// A view painted by how far each pixel may be off.
#include "classes.glsl"
#include "luma.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2D shown;
layout(binding = 1) uniform sampler2D doubt;  // as TrustPass has it
layout(binding = 0, rgba8) uniform writeonly image2D picture;

const float kSmall = 10.5, kLarge = 30.5;  // grey levels
const int kUnconfirmed = 255;
// As what is assumed before anything is learnt (seat/shown_fidelity.cpp).
const float kOwnPx[] = float[](0.7, 0.25, 0.35, 0.5, 0.7, 1.5, 1.0), kReachPx[] = float[](1.0, 4.0), kReachOfSigma = 0.5;
const int kOfOne = 32, kSuspect = 6 * kOfOne;  // and beyond

// Grey levels by which a pixel of this kind may be off (doubt_kinds.hpp).
float levels_of(int kind) {
  float contrast = 3.0 * (exp2((float(kind % 16) + 0.5) / 4.0) - 1.0);
  return contrast * length(vec2(kOwnPx[min(kind / kOfOne, 6)], kReachOfSigma * kReachPx[kind / 16 % 2]));
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(picture)))) return;
  vec4 colour = texelFetch(shown, pixel, 0);
  int kind = int(round(255.0 * texelFetch(doubt, pixel, 0).r));
  float off = levels_of(kind);
  int level = kind == kUnconfirmed ? 3 : kind >= kSuspect || off >= kLarge ? 2 : off >= kSmall ? 1 : 0;
  float grey = luma_of(colour.rgb);
  imageStore(picture, pixel, colour.a > 0.0 ? vec4(class_colour(pixel, level, grey), colour.a) : colour);
}
