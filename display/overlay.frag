// A stroke of an overlay: smooth edges, dashes, and dimmer and dotted where the model hides it.
#include "camera.glsl"
layout(std140, binding = 0) uniform Camera { CameraBlock camera; };
layout(binding = 1) uniform sampler2DArray depths;  // kNear / z, 0: no model
uniform vec4 rim;                                   // colour instead of the stroke's own; w: how much of it
in vec2 px;
in vec3 p_camera;
flat in vec4 colour;
flat in vec4 shape;
in float along;
layout(location = 0) out vec4 shown;

const float kBehind = 0.006;     // m: what is nearer to a surface than this lies on it
const float kDotted = 0.008;     // m, of a dot and the gap after it, where it is hidden
const float kOverlap = 0.5;      // px of one stroke of a line with the next
const float kHidden = 0.5;       // of its opacity, there

bool hidden() {
  vec3 place;
  float inverse_z;
  if (!project_face(camera, p_camera, place, inverse_z)) return false;
  float nearest = texelFetch(depths, ivec3(ivec2(floor(place.xy + 0.5)), int(place.z)), 0).r;
  return nearest > 0.0 && 1.0 / inverse_z > kNear / nearest + kBehind;
}

void main() {
  int ends = int(shape.w + 0.5);
  float off = abs(px.y);
  if (px.x < 0.0) {
    if ((ends & 1) == 0 && px.x < -kOverlap) discard;
    off = length(px);
  } else if (px.x > shape.x) {
    if ((ends & 2) == 0 && px.x > shape.x + kOverlap) discard;
    off = length(vec2(px.x - shape.x, px.y));
  }
  float cover = clamp(shape.y - off + 0.5, 0.0, 1.0);
  if (shape.z > 0.0 && fract(along / shape.z) > 0.6) discard;
  float opacity = colour.a;
  if (hidden()) {
    if (fract(along / kDotted) > 0.5) discard;
    opacity *= kHidden;
  }
  if (cover <= 0.0) discard;
  shown = vec4(mix(colour.rgb, rim.rgb, step(0.001, rim.w)), cover * opacity * (rim.w > 0.0 ? rim.w : 1.0));
}
