// Which fragments are of a part of a view (gl::ViewPart).
#include "near.glsl"
uniform vec2 between;  // 1/m: of the farthest, and of the nearest surface
uniform int behind;    // 1: what lies behind near sides of edges
layout(binding = 1) uniform sampler2D seen;   // 1/m
layout(binding = 2) uniform sampler2D edges;  // of blocks: green: least 1/m around; blue: not 0 near an edge
const float kFarther = 0.98;                  // of inverse depth: what is less far behind is the same surface
const float kNearSide = 0.9;                  // likewise: something around is clearly farther than what is seen
const int kBlock = 8;                         // px

bool is_left_out() {
  float q = gl_FragCoord.z / kNear;
  if (q < between.x || q >= between.y) return true;
  if (behind == 0) return false;
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 around = texelFetch(edges, pixel / kBlock, 0);
  float front = texelFetch(seen, pixel, 0).r;
  if (around.b == 0.0 || around.g > kNearSide * front) return true;
  // Rows run downwards: what faces the camera turns the other way round.
  return gl_FrontFacing || q >= kFarther * front;
}
