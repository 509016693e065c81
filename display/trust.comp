// Of what kind each pixel of a drawn view is, of those that can be trusted more or less, and the view with all else hatched. A pixel's point goes back with
// its node to where it was when each of the last images was taken; the newest one that saw it says what is known of it:
//
//   view --depth--> point --moves with its node--> image 0, 1, 2 ... newest first: outside, hidden or seen
//
// Defines: FRAMES, how many of them are remembered; COMPARISONS, how many of those that were compared; CODED_AWAY,
// MOSTLY_CODED_AWAY and BESIDE_EDGE, where kinds of doubt_kinds.hpp begin; ANYWHERE_PX, there; TOLD_STEPS, LOSS_CONTRASTS
// and STEPS_A_CONTRAST of coding_loss.hpp.
#include "camera.glsl"
#include "luma.glsl"
#include "view_alpha.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(std140, binding = 0) uniform Camera { CameraBlock camera; };  // of the images
layout(std140, binding = 1) uniform View { CameraBlock view; };      // the same lens, perhaps of another size
layout(binding = 0) uniform sampler2D shown;
layout(binding = 1) uniform usampler2DArray surfaces;  // triangle + 1
layout(binding = 2) uniform sampler2DArray depth;
layout(binding = 3) uniform samplerBuffer triangles;
layout(binding = 4) uniform sampler2D rays;
layout(binding = 5) uniform samplerBuffer node_px;  // by how many pixels each node may be elsewhere
// Per image and node: rows of T_then_now, from the view's camera to that image's for what moves with the node; and by
// how much the node has turned since. The last set belongs to the image that was compared.
layout(binding = 6) uniform samplerBuffer ways;
layout(binding = 7) uniform sampler2DArray seen_depth;  // faces of image 0, of image 1, ...
layout(binding = 8) uniform sampler2DArray comparisons;  // of compared images with what was shown (doubt_kinds.hpp)
layout(binding = 9) uniform usampler2DArray losses;  // steps of what coding took away, by tile of image 0, ...
layout(binding = 0, r8) uniform writeonly image2D doubt;
layout(binding = 1, rgba8) uniform writeonly image2D marked;
uniform int layer_of[FRAMES];  // each image's first
uniform int frame_count, node_count, faces;
uniform uint exact[8];  // a bit for each kind of pixel (doubt_kinds.hpp): it counts as exact
uniform int layer_of_comparison[COMPARISONS];  // newest first
uniform int comparison_count, comparisons_with_patches;  // the newest ones

const float kUnconfirmed = 1.0;
const float kSameSurface = 0.02;  // share of the distance within which a surface is the one that was seen
const float kTurned = 0.5;         // share of a part's brightness that its turning by a radian may change
const float kWrong = 10.0 / 255.0;  // levels by which light on a part may change until it has to be seen anew

bool ray_through(ivec2 pixel, out vec3 ray) {
  if (lens_model(view) == 0) {
    ray = vec3((vec2(pixel) - view.focal.zw) / view.focal.xy, 1.0);
    return true;
  }
  vec4 r = texelFetch(rays, pixel, 0);
  ray = r.xyz;
  return r.w > 0.5;
}

vec3 where(int set, int node, vec3 p) {
  int row = 4 * (set * node_count + node);
  vec4 h = vec4(p, 1.0);
  return vec3(dot(texelFetch(ways, row), h), dot(texelFetch(ways, row + 1), h), dot(texelFetch(ways, row + 2), h));
}

const int kOutside = 0, kHidden = 1, kSeen = 2;
int look(int frame, vec3 p) {
  vec3 place;
  float inverse_z;
  vec2 pixel;
  if (!project_face(camera, p, place, inverse_z) || !project_lens(camera, p, pixel)) return kOutside;
  if (any(lessThan(pixel, vec2(0.5))) || any(greaterThan(pixel, camera.size.xy - 1.5))) return kOutside;
  vec4 near_over_z = textureGather(seen_depth, vec3((place.xy + 0.5) / camera.size.zw, place.z + float(layer_of[frame])));
  vec4 known = mix(near_over_z, vec4(1e30), equal(near_over_z, vec4(0.0)));
  float farthest = min(min(known.x, known.y), min(known.z, known.w)) / kNear;
  return farthest > inverse_z * (1.0 + kSameSurface) ? kHidden : kSeen;
}

// Grey levels by which the pixels around differ from this one (scene/contrast.hpp).
float contrast_at(ivec2 pixel, float here) {
  float sum = 0.0;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      vec3 c = texelFetch(shown, clamp(pixel + ivec2(x, y), ivec2(0), ivec2(view.size.xy) - 1), 0).rgb;
      float difference = luma_of(c) - here;
      sum += difference * difference;
    }
  return 255.0 * sqrt(sum / 8.0);
}

int node_at(ivec3 place) {
  uint surface = texelFetch(surfaces, place, 0).r;
  return surface == 0u ? -1 : int(texelFetch(triangles, 2 * int(surface - 1u) + 1).y);
}

// Of the surface seen here and of those beside it, which may cover it or uncover what is behind.
float uncertain_px(ivec3 place, int node) {
  float px = texelFetch(node_px, node).r;
  for (int i = 0; i < 4; ++i) {
    ivec2 step = ivec2(i == 0 ? 1 : i == 1 ? -1 : 0, i == 2 ? 1 : i == 3 ? -1 : 0);
    int beside = node_at(ivec3(clamp(place.xy + step, ivec2(0), ivec2(view.size.zw) - 1), place.z));
    if (beside >= 0 && beside != node) px = max(px, texelFetch(node_px, beside).r);
  }
  return px;
}

// Steps as DoubtKind has them (doubt_kinds.hpp).
const int kNever = 0, kSame = 1, kAlike = 2, kClose = 3, kNearlyAlike = 4, kOff = 5, kSuspect = 6;
const float kInPatch = 253.5, kNotShown = 254.5;  // levels beyond these

// What a comparison said of the place, kNotShown and beyond where it was not shown.
float said(int comparison, int node, vec3 p) {
  vec2 at;
  if (!project_lens(camera, where(FRAMES + comparison, node, p), at)) return 255.0;
  ivec2 pixel = ivec2(floor(at + 0.5));
  if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, ivec2(camera.size.xy)))) return 255.0;
  return 255.0 * texelFetch(comparisons, ivec3(pixel, layer_of_comparison[comparison]), 0).r;
}

int compared_at(int node, vec3 p) {
  float sum = 0.0, count = 0.0;
  for (int i = 0; i < comparison_count; ++i) {
    float levels = said(i, node, p);
    if (levels > kNotShown) continue;
    if (levels > kInPatch && i >= comparisons_with_patches) continue;
    if (levels > kInPatch && i == 0) return kSuspect;
    sum += min(levels, 30.0);
    count += 1.0;
  }
  if (count == 0.0) return kNever;
  float levels = sum / count;
  return levels <= 1.5 ? kSame : levels <= 2.5 ? kAlike : levels <= 4.5 ? kClose : levels <= 6.5 ? kNearlyAlike : kOff;
}

int step_of_contrast(float levels) {
  return clamp(int(4.0 * log2(1.0 + levels / 3.0)), 0, 15);
}
int step_of_reach(float px) {
  return px < 2.0 ? 0 : 1;
}

uint lost_at(int frame, vec3 p) {
  vec2 pixel;
  if (!project_lens(camera, p, pixel)) return 0u;
  ivec2 tiles = textureSize(losses, 0).xy;
  ivec2 tile = ivec2((pixel + 0.5) / camera.size.xy * vec2(tiles));
  return texelFetch(losses, ivec3(clamp(tile, ivec2(0), tiles - 1), layer_of[frame] / faces), 0).r;
}

int coded_away(int step, int contrast) {
  int kind = CODED_AWAY + LOSS_CONTRASTS * (step - 1) + min(contrast / STEPS_A_CONTRAST, LOSS_CONTRASTS - 1);
  return step <= TOLD_STEPS ? kind : MOSTLY_CODED_AWAY;
}

float kind_at(ivec2 pixel, vec3 colour, bool certain) {
  vec3 ray, place;
  float inverse_z;
  if (!ray_through(pixel, ray) || !project_face(view, ray, place, inverse_z)) return kUnconfirmed;
  ivec3 at = ivec3(ivec2(floor(place.xy + 0.5)), int(place.z));
  int node = node_at(at);
  float near_over_z = texelFetch(depth, at, 0).r;
  if (node < 0 || near_over_z <= 0.0) return kUnconfirmed;
  vec3 p = ray * (kNear / near_over_z * inverse_z);

  int found = -1, newest = kOutside;
  vec3 then;  // in the image that was found
  for (int frame = 0; frame < frame_count && found < 0; ++frame) {
    then = where(frame, node, p);
    int seen = look(frame, then);
    if (frame == 0) newest = seen;
    if (seen == kSeen) found = frame;
  }
  // What covered it in the newest image may have left its shadow there, or have pushed it.
  float uncertain = uncertain_px(at, node);
  if (found < 0 || newest == kHidden || uncertain >= ANYWHERE_PX) return kUnconfirmed;
  float here = luma_of(colour);
  int contrast = step_of_contrast(contrast_at(pixel, here));
  int lost = int(lost_at(found, then));
  if (lost > 0) return certain ? float(coded_away(lost, contrast)) / 255.0 : kUnconfirmed;
  if (!certain) return float(BESIDE_EDGE + contrast / 2) / 255.0;
  float turned = texelFetch(ways, 4 * (found * node_count + node) + 3).x;
  int compared = kTurned * turned * here > kWrong ? kSuspect : compared_at(node, p);
  int kind = contrast + 16 * (step_of_reach(uncertain) + 2 * compared);
  return float(kind) / 255.0;
}

// Stripes that differ from the picture's own brightness; those of filled holes lean to the other side.
vec4 hatched(ivec2 pixel, vec4 colour) {
  int along = is_image_or_edge(colour.a) ? pixel.x + pixel.y : pixel.x - pixel.y + 6 * int(view.size.y);
  if (along % 6 >= 2) return colour;
  bool bright = luma_of(colour.rgb) > 0.5;
  return vec4(mix(colour.rgb, vec3(bright ? 0.0 : 1.0), 0.45), colour.a);
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, ivec2(view.size.xy)))) return;
  vec4 colour = texelFetch(shown, pixel, 0);
  bool seen = is_image_or_edge(colour.a), certain = is_from_image(colour.a);
  float value = seen ? kind_at(pixel, colour.rgb, certain) : kUnconfirmed;
  imageStore(doubt, pixel, vec4(value));
  uint kind = uint(round(255.0 * value));
  bool hatch = (exact[kind >> 5] >> (kind & 31u) & 1u) == 0u && is_coloured(colour.a);
  imageStore(marked, pixel, hatch ? hatched(pixel, colour) : colour);
}
