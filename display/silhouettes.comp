// Pixels of a view at which a surface ends before another one: a camera's pixel holds a share of both, by its area and by
// the spread of lens and sensor. Colours that were looked up on either side hold none: images are not trusted beside such edges.
// So each of these pixels becomes a mean of its neighbours.
//
// STEP 0: lists tiles of 4x4 pixels that may hold some. STEP 1: of these, the pixels. STEP 2: their means. STEP 3: puts them
// into the picture.
#include "camera.glsl"
#include "depth_slope.glsl"
#if STEP > 0
#define WORK_UNIT 5
#if STEP == 1
#define INVOCATIONS_PER_ITEM 16
#else
#define INVOCATIONS_PER_ITEM 1
#endif
layout(local_size_x = 64) in;
#include "work_item.glsl"
#else
layout(local_size_x = 32, local_size_y = 2) in;
layout(binding = 8) uniform sampler2DArray steps;  // of each 4x4 tile of the faces: face_steps.comp
#endif
#if STEP < 2
#include "work_list.glsl"
#else
layout(binding = 2, std430) buffer Means { uint means[]; };  // RGBA8 of each listed pixel; 0: it has no colour
layout(binding = 0, rgba8) uniform image2D picture;
#endif
layout(std140, binding = 0) uniform Camera { CameraBlock camera; };
#include "view_ray.glsl"

// Where on the faces the pixel looks.
bool find_place(ivec2 pixel, out vec3 place) {
  vec3 ray;
  float inverse_z;
  return ray_through(pixel, ray) && project_face(camera, ray, place, inverse_z);
}

#if STEP == 0
bool has_step(ivec2 tile, float layer) {
  return texelFetch(steps, ivec3(tile, layer), 0).r > 0.5;
}

// Whether a tile of the faces is marked that is near what the tile shows: edges that count lie up to two pixels from it.
bool may_have_step(ivec2 tile) {
#if defined(FACE_IS_IMAGE) && FACE_IS_IMAGE
  return has_step(tile, 0.0);
#else
  vec3 least = vec3(1e9), most = vec3(-1e9);
  bool all_found = true;
  for (int i = 0; i < 4; ++i) {
    vec3 place;
    bool found = find_place(min(4 * tile + 3 * ivec2(i & 1, i >> 1), ivec2(camera.size.xy) - 1), place);
    least = found ? min(least, place) : least;
    most = found ? max(most, place) : most;
    all_found = all_found && found;
  }
  bool any_found = most.z >= 0.0;
  if (!any_found) return false;
  bool marked = !all_found || least.z != most.z;  // at the rim of what is seen, or across an edge of the cube
  ivec2 first = max(ivec2(floor(least.xy + 0.5)) - 2, ivec2(0)) / 4, last = min(ivec2(floor(most.xy + 0.5)) + 2, face_size - 1) / 4;
  for (int y = first.y; y <= last.y && !marked; ++y)
    for (int x = first.x; x <= last.x && !marked; ++x) marked = has_step(ivec2(x, y), least.z);
  return marked;
#endif
}

void main() {
  ivec2 tile = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(4 * tile, ivec2(camera.size.xy))) || !may_have_step(tile)) return;
  append_work(uint(4 * tile.x) | uint(4 * tile.y) << 16);
}
#elif STEP == 1
// Of a row of four pixels, does a surface end between the inner two: is one of them in front of the other, and of where its
// surface would go on?
bool parts(float a, float b, float c, float d) {
  return (steps_back(b, c) && ends_between(a, b, c, d)) || (steps_back(c, b) && ends_between(d, c, b, a));
}

// Whether a surface ends beside `at`, along its row or column. `way`: to the side of it to which the view's pixel looks.
bool parts_along(ivec3 at, ivec2 way, float center) {
  float before2 = inverse_z(at.xy - 2 * way, at.z), before = inverse_z(at.xy - way, at.z), after = inverse_z(at.xy + way, at.z),
        after2 = inverse_z(at.xy + 2 * way, at.z);
  bool found = parts(before2, before, center, after) || parts(before, center, after, after2);
  // Where a lens bends the picture, its pixels are up to two of the face apart.
  if (lens_model(camera) != 0) found = found || parts(center, after, after2, inverse_z(at.xy + 3 * way, at.z));
  return found;
}

bool holds_both(vec3 place) {
  vec2 at = floor(place.xy + 0.5);
  ivec3 pixel = ivec3(at, place.z);
  float center = inverse_z(pixel.xy, pixel.z);
  ivec2 way = ivec2(place.x < at.x ? -1 : 1, place.y < at.y ? -1 : 1);
  return center > 0.0 && (parts_along(pixel, ivec2(way.x, 0), center) || parts_along(pixel, ivec2(0, way.y), center));
}

void main() {
  uint tile;
  if (!next_work(tile)) return;
  ivec2 pixel = ivec2(tile & 0xffffu, tile >> 16) + ivec2(gl_LocalInvocationIndex & 3u, (gl_LocalInvocationIndex >> 2) & 3u);
  vec3 place;
  if (any(greaterThanEqual(pixel, ivec2(camera.size.xy))) || !find_place(pixel, place)) return;
  if (holds_both(place)) append_work(uint(pixel.x) | uint(pixel.y) << 16);
}
#elif STEP == 2
// exp(-1 / (2 * 0.6^2)): a deviation of 0.6 px, of which the pixel's own area is 0.3 along each axis.
const float kBeside = 0.25;
const float kColoured = 0.5;  // alpha of less: no colour at all

void main() {
  uint item;
  if (!next_work(item)) return;
  uint index = index_of_work();
  ivec2 pixel = ivec2(item & 0xffffu, item >> 16);
  means[index] = 0u;
  vec4 own = imageLoad(picture, pixel);
  if (own.a < kColoured) return;
  vec4 sum = vec4(0.0);
  for (int i = 0; i < 9; ++i) {
    ivec2 o = ivec2(i % 3, i / 3) - 1;
    ivec2 to = pixel + o;
    if (any(lessThan(to, ivec2(0))) || any(greaterThanEqual(to, ivec2(camera.size.xy)))) continue;
    vec4 colour = imageLoad(picture, to);
    float weight = (o.x == 0 ? 1.0 : kBeside) * (o.y == 0 ? 1.0 : kBeside);
    if (colour.a >= kColoured) sum += weight * vec4(colour.rgb, 1.0);
  }
  means[index] = packUnorm4x8(vec4(sum.rgb / sum.a, own.a));
}
#else
void main() {
  uint item;
  if (!next_work(item)) return;
  uint index = index_of_work();
  if (means[index] != 0u) imageStore(picture, ivec2(item & 0xffffu, item >> 16), unpackUnorm4x8(means[index]));
}
#endif
