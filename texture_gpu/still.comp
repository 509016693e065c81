// For how many seconds each surface point of the newest image (camera 0) has looked as it does now: as many as in the image
// before (camera 1), and those since then, where the two agree; 0 where they do not, or where that did not see it. One
// invocation for 2x2 pixels.
//
// Gloss moves with the camera, and adds the same white light whatever the surface: so much of it is let pass as may have
// come or gone while the camera moved. While it stands, nothing but noise is.
#include "camera.glsl"
#include "seen.glsl"
#include "image_taps.glsl"
#include "vignetting.glsl"
#include "image_point.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 8) uniform sampler2D still_before;
layout(binding = 0, r32f) uniform writeonly image2D still;
uniform mat4 T_before_newest;  // of the cameras
uniform float interval;        // s between the two

const float kGloss = 10.0;    // linear light that the edge of a lamp's mirror image adds per radian
const float kNoise = 0.03;    // of a value
const float kWhite = 0.98;    // of a pixel: it may be of any brightness

// Linear light, nearly, at the exposure of the textures: between these two.
struct Light {
  vec3 least, most;
};

Light light_of(vec4 tone, vec4 raw, vec2 pixel, vec2 size) {
  vec3 value = unscaled(raw) * without_vignetting(tone, pixel, size) * tone.x;
  return Light(value * value, mix(value * value, vec3(1e3), greaterThan(raw.rgb, vec3(kWhite))));
}

// Whether some amount of white light, up to `gloss` more or less, makes the newest pixels look like one of those around the
// place in the image before.
bool agree(ivec2 newest, vec2 before, float gloss) {
  vec2 size = cameras[0].size.xy;
  // Means of 2x2 pixels.
  Light now = light_of(cameras[0].tone, textureLod(image0, (vec2(newest) + 1.0) / size, 0.0), vec2(newest) + 0.5, size);
  Light then = Light(vec3(1e3), vec3(0.0));
  for (int i = 0; i < 5; ++i) {
    vec2 place = before + 0.5 + (i == 4 ? vec2(0.0) : vec2(i & 1, i >> 1) * 2.0 - 1.0);
    Light tap = light_of(cameras[1].tone, textureLod(image1, (place + 0.5) / size, 0.0), place, size);
    then = Light(min(then.least, tap.least), max(then.most, tap.most));
  }
  vec3 noise = kNoise * (2.0 * sqrt(now.least) + kNoise);
  vec3 least = now.least - then.most - noise, most = now.most - then.least + noise;
  return max(max(least.r, max(least.g, least.b)), -gloss) <= min(min(most.r, min(most.g, most.b)), gloss);
}

void main() {
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  ivec2 pixel = 2 * texel;
  if (any(greaterThanEqual(texel, imageSize(still)))) return;
  float since = 0.0;
  vec3 p;
  vec2 before;
  if (find_point(pixel, p)) {
    vec3 q = (T_before_newest * vec4(p, 1.0)).xyz;
    if (is_seen(1, q, before)) {
      vec3 sight = normalize(p), sight_before = normalize(transpose(mat3(T_before_newest)) * q);
      if (agree(pixel, before, kGloss * length(cross(sight, sight_before))))
        since = texelFetch(still_before, ivec2(before) / 2, 0).r + interval;
    }
  }
  imageStore(still, texel, vec4(since));
}
