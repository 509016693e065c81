// The predicted view: per pixel, lens ray -> triangle -> surface point -> chart -> texels, or -> one of the newest images.
//
// Software renderers run both sides of every branch. So most pixels are drawn by a program that knows only the usual
// case, texels about as large as pixels, and lists the others; a second program draws what is listed. Where the newest
// images are looked up directly, four programs follow each other:
//
//   newest image, all pixels     what it does not show is listed
//   textures, of these           what the image before shows is listed for it, texels of other sizes for the last
//   image before, of these       what it shows in part only is listed for the last
//   every case, of these
//
// view.comp chooses the pixels. Defines: CASES 0: an image; 1: the usual case; 2: every case.
//          LEVELS: seen_plane.glsl. LISTED: 1 where the pixels come from a list. BLENDED: 1 where the picture holds newer
//          images already. BEFORE: 1 where what the image before shows is left to it.
//          HOMOGRAPHIES: 1 where those of the triangles' planes to the image are there (homographies.comp).
//          KEPT: 1 for an image that is blended over the newest one where it saw from the eye's side (kept.glsl).
//
// Where a texture has one level, its texels are loaded as an image's: software renderers fetch a texture's after looking up the
// level for each lane by itself (docs/decisions/0050).
#define IMAGE 0
#define USUAL 1
#define EVERY 2
uniform float sharp;  // share of the cubic filter, of images or of textures (sharpness.hpp)

// The image as the view's own camera would have it: lens and sensor spread a point over a deviation of some 0.6 px, of each
// camera's own pixels. Where the view shows things smaller than the image, that is more of the image's pixels, and the filter is the
// softer; where it shows them larger, it takes some of the image's spread away. `finer`: pixels of the image for one of the view. A
// share of 1 - 6 v of the cubic filter spreads by a variance of v (sharpness.hpp).
const float kSpread = 0.6, kSharpest = 1.5, kSoftest = -1.0;
float sharp_for(float finer) {
  return clamp(sharp - 6.0 * kSpread * kSpread * (finer * finer - 1.0), kSoftest, kSharpest);
}

#include "camera.glsl"
#include "view_alpha.glsl"
#include "vignetting.glsl"
#if CASES == IMAGE || BEFORE
#define SEEN_BLOCK 1
#define SEEN_UNIT 16
#include "seen.glsl"
#endif
#if CASES == IMAGE
#include "image_taps.glsl"
#include "view_taps.glsl"
#else
#include "chart_record.glsl"
#include "atlas.glsl"
uniform float gain;
layout(binding = 10) uniform samplerBuffer page_ages;  // s; negative: never seen
uniform float light_age;  // s; of colours that are older it is not known which shadows are in them
vec3 brightest;  // of what the pixel can show
#define BRIGHTEST brightest
// What textures hold is no sharper for being seen from nearer, and softer from farther away (sharpness.hpp).
#define SHARP_FOR(finer) min(sharp, sharp_for(finer))
#include "lookup.glsl"
#endif
#if CASES != EVERY
#include "work_list.glsl"
#endif
layout(std140, binding = 0) uniform Camera { CameraBlock camera; };
layout(binding = 0) uniform samplerBuffer view_nodes;    // T_node_camera
layout(binding = 1, r32ui) readonly uniform uimage2DArray surfaces;    // triangle + 1
layout(binding = 2) uniform samplerBuffer triangles;
layout(binding = 3) uniform samplerBuffer patches;
#include "seen_plane.glsl"
#include "view_ray.glsl"
layout(binding = 2, rgba8) readonly uniform image2D light;  // ShadowPass::light(), or white, and smaller
#if BLENDED || KEPT
layout(binding = 0, rgba8) uniform image2D picture;
#else
layout(binding = 0, rgba8) uniform writeonly image2D picture;
#endif

// Weight of an image that may show another surface: it counts only where nothing else shows the point.
const float kUncertain = 1.0 / 255.0;

// A pixel counts as seen when at least this share of its filter weight lies on seen texels.
const float kSeenShare = 0.25;

uniform vec3 white_balance;  // the newest image's, beside what is looked up
vec3 pixel_tone;             // that, and what the view's own lens leaves of the pixel's value (camera.tone)
vec3 pixel_light;            // and shadows of moving parts

void find_light(ivec2 pixel) {
  pixel_tone = white_balance * exp(log_vignetting(camera.tone, vec2(pixel), camera.size.xy));
  pixel_light = pixel_tone * imageLoad(light, min(pixel, imageSize(light) - 1)).rgb;
#if CASES != IMAGE
  brightest = 1.0 / (gain * pixel_tone);
#endif
}

// What a pixel shows.
struct Surface {
  vec3 ray;      // of the view's camera
  ivec3 at;      // of the faces
  uint number;   // triangle + 1
};

// False where no model is.
bool find_surface(ivec2 pixel, out Surface found) {
  find_light(pixel);
  if (!ray_through(pixel, found.ray)) return false;
#if defined(FACE_IS_IMAGE) && FACE_IS_IMAGE
  found.at = ivec3(pixel, 0);
#else
  vec3 place;
  float inverse_z;
  if (!project_face(camera, found.ray, place, inverse_z)) return false;
  found.at = ivec3(ivec2(floor(place.xy + 0.5)), int(place.z));
#endif
  found.number = imageLoad(surfaces, found.at).r;
  return found.number != 0u;
}

// The surface point that a pixel shows.
struct Point {
  int patch_index, node;
  vec3 normal;  // in the node's frame, as all of it
  vec3 sight;   // the pixel's ray, not of unit length
  float t;      // the point lies so many of `sight` from the camera
  vec3 p;
};

// False where no model is.
bool find_point(ivec2 pixel, out Point found) {
  Surface shown;
  if (!find_surface(pixel, shown)) return false;
  vec4 plane = seen_plane(shown.at, shown.number);
  vec4 ids = texelFetch(triangles, 2 * int(shown.number - 1u) + 1);
  int node = int(ids.y);

  // The ray in the node's frame meets the triangle's plane.
  vec4 x = texelFetch(view_nodes, 3 * node), y = texelFetch(view_nodes, 3 * node + 1), z = texelFetch(view_nodes, 3 * node + 2);
  vec3 d = vec3(dot(x.xyz, shown.ray), dot(y.xyz, shown.ray), dot(z.xyz, shown.ray));
  vec3 o = vec3(x.w, y.w, z.w);
  float facing = dot(plane.xyz, d);
  float t = (plane.w - dot(plane.xyz, o)) / (abs(facing) > 1e-9 ? facing : 1e-9);
  found = Point(int(ids.x), node, plane.xyz, d, t, o + t * d);
  return true;
}

#if CASES == IMAGE || BEFORE
#include "sightings.glsl"
#endif

#if KEPT
#include "kept.glsl"
#elif CASES == IMAGE
// The image's colour at the point, at the exposure of the newest one, and its weight beside what older images saw; 0
// where it does not see it.
vec4 image_colour(Sighting seen) {
  if (seen.weight == 0.0) return vec4(0.0);
  vec2 size = cameras[0].size.xy;
  vec3 colour = unscaled(sample_for_view(seen.pixel, ivec2(size), sharp_for(seen.finer), seen.finer)) * without_vignetting(cameras[0].tone, seen.pixel, size);
  return vec4(min(cameras[0].tone.x * colour * pixel_light, vec3(1.0)), seen.weight);
}

const float kAll = 0.999;  // a weight that leaves nothing

// Both with weights; what `front` leaves is for `back`.
vec4 over(vec4 front, vec4 back) {
  float share = (1.0 - front.a) * back.a, weight = front.a + share;
  return vec4((front.a * front.rgb + share * back.rgb) / max(weight, 1e-6), weight);
}
#else
// What a pixel shows of a chart.
struct Place {
  int chart_index;
  ChartRecord chart;
  vec2 texel;  // of level 0
  int level;   // whose texels are about as large as the pixel
  float finer; // so many of its texels are one pixel, on the less crowded axis
};

Place place_of(Point point) {
  Place place;
  int first = 4 * point.patch_index;
  vec4 a = texelFetch(patches, first), b = texelFetch(patches, first + 1), c = texelFetch(patches, first + 2),
       e = texelFetch(patches, first + 3);
  vec2 uv = vec2(dot(point.p - a.xyz, b.xyz), dot(point.p - a.xyz, c.xyz));
  ivec2 cells = ivec2(int(a.w), int(b.w));
  ivec2 cell = clamp(ivec2(floor(uv / e.xy)), ivec2(0), cells - 1);
  place.chart_index = int(c.w) + cell.y * cells.x + cell.x;
  place.chart = read_chart(published_charts, place.chart_index);
  place.texel = (uv - place.chart.uv0) * place.chart.density;
  // Where even the less crowded axis has more texels than pixels, coarser levels hold the means.
  vec3 sight = normalize(point.sight);
  vec3 du = place.chart.eu - sight * dot(sight, place.chart.eu), dv = place.chart.ev - sight * dot(sight, place.chart.ev);
  float pixels_per_texel = max(camera.focal.x, camera.focal.y) * max(length(du), length(dv)) / (abs(point.t) * length(point.sight));
  float lod = -log2(max(pixels_per_texel, 1e-6));
  place.level = clamp(int(floor(lod + 0.15)), 0, 4);
  place.finer = 1.0 / (max(pixels_per_texel, 1e-6) * float(1 << place.level));
  return place;
}

// Shadows are drawn where the texture is without.
void choose_light(Place place) {
  ivec2 page = clamp(ivec2(place.texel) >> 4, ivec2(0), place.chart.pages - 1);
  float age = texelFetch(page_ages, place.chart.first_page + page.y * place.chart.pages.x + page.x).r;
  if (age > light_age) pixel_light = pixel_tone;
}

// What textures show of a pixel, beside what images do with a weight.
vec4 beside(vec4 image, vec4 textures) {
  bool certain = image.a > 1.5 * kUncertain;
  float share = textures.a < kFromImage ? 1.0 : certain ? image.a : 0.0;
  return vec4(mix(textures.rgb, image.rgb, share), max(textures.a, certain ? kFromImage : kFromEdge));
}

vec4 shown(vec4 sum, float alpha) {
  return vec4(min(sum.rgb / sum.a * gain * pixel_light, vec3(1.0)), alpha);
}

// Of texels around the place; a 0 where none of them has a colour.
vec4 shown(Taps taps) {
  if (taps.seen.a >= kSeenShare) return shown(taps.seen, kFromImage);
  vec4 all = taps.seen + taps.filled;
  return all.a > 0.0 ? shown(all, kFromFill) : vec4(0.0);
}

// Where no texel around the place has a colour.
vec4 filled(Place place) {
  vec4 mean = place.chart.density.x > 0.0 ? coarse_colour(place.chart, place.chart_index, place.texel)
                                          : texelFetch(published_means, place.chart_index);
  return mean.a > 0.0 ? shown(vec4(mean.rgb, 1.0), kFromFill) : vec4(vec3(0.0), kBare);
}

vec4 shade(Place place) {
  if (place.chart.density.x > 0.0) {
    Taps taps;
    if (place.level <= kCoarsestSharp)
      taps = gather_sharp_taps(place.chart, place.texel, place.level, place.finer);
    else
      taps = gather_taps(place.chart, place.texel, place.level);
    vec4 colour = shown(taps);
    if (colour.a > 0.0) return colour;
  }
  return filled(place);
}
#endif

#if CASES != EVERY
void leave_to_next(ivec2 pixel) {
  append_work(uint(pixel.x) | uint(pixel.y) << 16);
}
#endif
#if BEFORE
layout(binding = 2, std430) buffer ListBefore { uint before_args[4]; uint before_items[]; };
void leave_to_before(ivec2 pixel) {
  before_items[atomicAdd(before_args[3], 1u)] = uint(pixel.x) | uint(pixel.y) << 16;
}
#endif

void draw(ivec2 pixel, vec4 colour) {
#if BLENDED && CASES != IMAGE
  vec4 newest = imageLoad(picture, pixel);  // its weight in alpha
  if (newest.a > 0.0) colour = beside(newest, colour);
#endif
  imageStore(picture, pixel, colour);
}

#if KEPT
void draw_pixel(ivec2 pixel) {
  Point point;
  if (!find_point(pixel, point)) return;
  vec4 kept = kept_colour(point), newest = imageLoad(picture, pixel);
  if (kept.a > 0.0) imageStore(picture, pixel, vec4(mix(newest.rgb, kept.rgb, kept.a), newest.a));
}
#elif CASES == IMAGE
// How the image shows a pixel; false where no model is.
bool find_sighting(ivec2 pixel, out Sighting seen) {
#if HOMOGRAPHIES
  Surface shown;
  bool on_model = find_surface(pixel, shown);
#else
  Point shown;
  bool on_model = find_point(pixel, shown);
#endif
  seen = Sighting(0.0, vec2(0.0), 1.0);
  if (on_model) seen = sighting_of(shown);
  return on_model;
}

void draw_pixel(ivec2 pixel) {
  Sighting seen;
  bool on_model = find_sighting(pixel, seen);
  vec4 colour = image_colour(seen);
#if BLENDED
  colour = over(imageLoad(picture, pixel), colour);
#endif
  if (on_model && colour.a < kAll) leave_to_next(pixel);
  draw(pixel, colour);
}
#elif CASES == USUAL
void draw_pixel(ivec2 pixel) {
  Point point;
  if (!find_point(pixel, point)) {
    draw(pixel, vec4(0.0));
    return;
  }
#if BEFORE
  if (is_certain(sighting_of(point))) {
    leave_to_before(pixel);
    return;
  }
#endif
  Place place = place_of(point);
  choose_light(place);
  vec4 colour = place.level == 0 ? shown(gather_sharp_taps(place.chart, place.texel, 0, place.finer)) : vec4(0.0);
#if LISTED  // much of what no image shows was never seen
  if (place.level == 0 && colour.a == 0.0) colour = filled(place);
#endif
  if (colour.a == 0.0)
    leave_to_next(pixel);
  else
    draw(pixel, colour);
}
#else
void draw_pixel(ivec2 pixel) {
  Point point;
  vec4 colour = vec4(0.0);
  if (find_point(pixel, point)) {
    Place place = place_of(point);
    choose_light(place);
    colour = shade(place);
  }
  draw(pixel, colour);
}
#endif
