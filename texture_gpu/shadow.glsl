// How much of the lamp moving parts hide from a point. Needs camera.glsl (kNear); ShadowMap::bind.
#ifndef SHADOW_UNIT
#define SHADOW_UNIT 3
#endif
layout(binding = SHADOW_UNIT) uniform sampler2DArray moving_depth;
layout(binding = SHADOW_UNIT + 1) uniform sampler2DArray still_depth;
layout(binding = SHADOW_UNIT + 2) uniform sampler2D shadow_cells;
uniform vec4 lamp_face;      // fx fy cx cy, px
uniform float lamp_radius;   // metres
uniform vec4 lamp_strength;  // square metres, for red, green and blue
const float kCell = 8.0;
const float kOffSurface = 0.01;   // metres: what is so little nearer to the lamp is the surface itself
const float kStillOff = 0.03;
const float kResponse = 2.2;      // lamp/lamp.hpp

// `q`: in the lamp's frame. The largest depth value around its place, where something may shade it; else 0.
float may_shade(vec3 q) {
  if (q.z <= kNear) return 0.0;
  vec2 place = lamp_face.xy * q.xy / q.z + lamp_face.zw;
  vec2 cell = (place + 0.5) / kCell;
  if (any(lessThan(cell, vec2(0.0))) || any(greaterThanEqual(cell, vec2(textureSize(shadow_cells, 0))))) return 0.0;
  float nearest = texelFetch(shadow_cells, ivec2(cell), 0).r;
  return nearest > kNear / (q.z - kOffSurface) ? nearest : 0.0;
}

vec2 on_disc(int i, int count) {  // Vogel's spiral
  float angle = 2.39996 * float(i);
  return sqrt((float(i) + 0.5) / float(count)) * vec2(cos(angle), sin(angle));
}

// What is at depth z hides the lamp's rim, `radius` to the side, at a place of the map that lies radius (1/z - 1/z_q)
// aside. The mean depth value of what may hide some of the lamp; 0: nothing. `more`: px of the map to look beyond.
float blocker_value(vec3 q, float nearest, float more) {
  const int kSearch = 8;
  vec2 place = lamp_face.xy * q.xy / q.z + lamp_face.zw;
  float bound = kNear / (q.z - kOffSurface), reach = lamp_face.x * lamp_radius / kNear * (nearest - kNear / q.z) + more;
  float sum = 0.0, count = 0.0;
  for (int i = 0; i < kSearch; ++i) {
    float w = texelFetch(moving_depth, ivec3(ivec2(floor(place + reach * on_disc(i, kSearch) + 0.5)), 0), 0).r;
    sum += w > bound ? w : 0.0;
    count += w > bound ? 1.0 : 0.0;
  }
  return sum / max(count, 1.0);
}

// Share of the lamp that moving parts hide, about as near to it as `blocker` (blocker_value): percentage-closer soft shadows
// (Fernando 2005).
float hidden_share(vec3 q, float blocker) {
  const int kFilter = 16;
  vec2 place = lamp_face.xy * q.xy / q.z + lamp_face.zw, size = vec2(textureSize(moving_depth, 0).xy);
  float value = kNear / q.z, bound = kNear / (q.z - kOffSurface);
  float spread = lamp_face.x * lamp_radius / kNear * max(blocker - value, 0.0);
  float hidden = 0.0;
  for (int i = 0; i < kFilter; ++i) {
    vec2 at = place + spread * on_disc(i, kFilter);
    vec4 over = step(vec4(bound), textureGather(moving_depth, vec3((at + 0.5) / size, 0.0)));
    vec2 f = fract(at);
    hidden += mix(mix(over.w, over.z, f.x), mix(over.x, over.y, f.x), f.y);
  }
  return hidden / float(kFilter);
}

// What stands still hides the lamp anyway.
bool in_still_shadow(vec3 q) {
  vec2 place = lamp_face.xy * q.xy / q.z + lamp_face.zw, size = vec2(textureSize(still_depth, 0).xy);
  vec4 over = textureGather(still_depth, vec3((place + 0.5) / size, 0.0));
  float far = min(min(over.x, over.y), min(over.z, over.w));
  return far > kNear / max(q.z - kStillOff, kNear);
}

// Factor on pixel values; `normal` towards the camera, in the lamp's frame too.
vec3 shadow_factor(vec3 q, vec3 normal, float blocker) {
  float d = length(q);
  float facing = max(-dot(normal, q) / d, 0.0) / (d * d);
  if (facing <= 0.0 || in_still_shadow(q)) return vec3(1.0);
  vec3 share = lamp_strength.rgb * facing;
  return pow((1.0 + share * (1.0 - hidden_share(q, blocker))) / (1.0 + share), vec3(1.0 / kResponse));
}
