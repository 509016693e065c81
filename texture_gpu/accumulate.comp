// The newest image (camera 0) as a mean over time: each pixel takes a share of what the image before (camera 1), which is such
// a mean itself, has at the same surface point. Noise of the sensor, and what falls between pixels, is less then.
//
// What was there before counts only as far as it lies between the pixels around (Karis, "High-Quality Temporal Supersampling",
// SIGGRAPH 2014): shadows, gloss and things that have moved are out of date at once.
#include "camera.glsl"
#include "seen.glsl"
#include "image_taps.glsl"
#include "vignetting.glsl"
#include "image_point.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 8) uniform samplerBuffer moved;  // three rows of each box that has moved: in it, all three are in -1 .. 1
layout(binding = 0, rgba8) uniform writeonly image2D mean;
uniform mat4 T_before_newest;  // of the cameras
uniform int boxes_moved;

const float kShare = 0.5;           // of the image before
// Of the cubic filter: a mean is sampled again with each image, and a share of 1 would blur it the more the older it gets.
const float kSharp = 1.6;
const float kNoise = 2.0 / 255.0;   // how far beyond the pixels around still is the same
const float kBeyond = 6.0 / 255.0; // from there on it is something else
const float kWhite = 0.98;         // of a pixel: it may be of any brightness

bool has_moved(vec3 p) {
  bool inside = false;
  for (int i = 0; i < boxes_moved; ++i) {
    vec4 at = vec4(p, 1.0);
    vec3 in_box = vec3(dot(texelFetch(moved, 3 * i), at), dot(texelFetch(moved, 3 * i + 1), at), dot(texelFetch(moved, 3 * i + 2), at));
    inside = inside || all(lessThan(abs(in_box), vec3(1.0)));
  }
  return inside;
}

vec3 value_at(ivec2 pixel) {
  return unscaled(texelFetch(image0, clamp(pixel, ivec2(0), textureSize(image0, 0) - 1), 0));
}

// What the image before has there, at the exposure of the newest one; false where it does not tell.
bool find_before(ivec2 pixel, out vec3 colour) {
  colour = vec3(0.0);
  vec3 p;
  vec2 at;
  if (!find_point(pixel, p) || has_moved(p) || !is_seen(1, (T_before_newest * vec4(p, 1.0)).xyz, at)) return false;
  vec2 size = cameras[1].size.xy;
  vec4 raw = sample_sharply(image1, at, size, kSharp);
  colour = unscaled(raw) * without_vignetting(cameras[1].tone, at, size) * cameras[1].tone.x /
           (without_vignetting(cameras[0].tone, vec2(pixel), cameras[0].size.xy) * cameras[0].tone.x);
  return max(raw.r, max(raw.g, raw.b)) < kWhite;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(mean)))) return;
  vec4 raw = texelFetch(image0, pixel, 0);
  vec3 now = unscaled(raw), before;
  bool known = find_before(pixel, before) && max(raw.r, max(raw.g, raw.b)) < kWhite;
  vec3 least = now, most = now;
  for (int i = 0; i < 4; ++i) {
    int step = 2 * (i & 1) - 1;
    vec3 beside = value_at(pixel + (i < 2 ? ivec2(step, 0) : ivec2(0, step)));
    least = min(least, beside), most = max(most, beside);
  }
  vec3 between = clamp(before, least - kNoise, most + kNoise), off = abs(before - between);
  float share = known ? kShare * (1.0 - smoothstep(0.0, kBeyond, max(off.r, max(off.g, off.b)))) : 0.0;
  imageStore(mean, pixel, vec4(mix(now, between, share) * raw.a, raw.a));
}
