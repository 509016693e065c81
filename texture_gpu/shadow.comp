// The factor that shadows of moving parts put on each pixel of a camera. First blocks of 4x4 pixels are listed that some
// might reach, then those of them where some do, and how near to the lamp what throws it is, then the pixels of these are
// computed: where nothing is listed, nothing is paid.
//
// Defines: STEP 0, 1, 2.
#include "camera.glsl"
#define SHADOW_UNIT 3
#include "shadow.glsl"
layout(std140, binding = 0) uniform Camera { CameraBlock camera; };
layout(binding = 1) uniform sampler2DArray depth;
layout(binding = 2) uniform sampler2D rays;
uniform mat4 T_lamp_camera;
#if STEP == 2
#define ITEMS_PER_GROUP 4
#define INVOCATIONS_PER_ITEM 16
#define WORDS_PER_ITEM 2
#include "work_item.glsl"
layout(local_size_x = 64) in;  // four blocks
layout(binding = 0, rgba8) uniform writeonly image2D light;
#elif STEP == 1
#define ITEMS_PER_GROUP 64
#include "work_item.glsl"
#include "work_list.glsl"
layout(local_size_x = 64) in;  // a block each
#else
#include "work_list.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
#endif

bool ray_through(ivec2 pixel, out vec3 ray) {
  ray = vec3((vec2(pixel) - camera.focal.zw) / camera.focal.xy, 1.0);
  if (lens_model(camera) == 0) return true;
  vec4 r = texelFetch(rays, min(pixel, textureSize(rays, 0) - 1), 0);
  ray = r.xyz;
  return r.w > 0.5;
}

#if STEP == 2
// Difference to the neighbour on the side that continues the surface.
float slope(float here, float before, float after) {
  float a = before > 0.0 ? here - before : 1e9, b = after > 0.0 ? after - here : 1e9;
  float least = abs(a) < abs(b) ? a : b;
  return abs(least) < 1e8 ? least : 0.0;
}

float depth_at(ivec3 at) {
  return texelFetch(depth, at, 0).r;
}

vec3 factor(ivec2 pixel, float blocker) {
  vec3 ray, place;
  float inverse_z;
  if (!ray_through(pixel, ray) || !project_face(camera, ray, place, inverse_z)) return vec3(1.0);
  ivec3 at = ivec3(ivec2(floor(place.xy + 0.5)), int(place.z));
  float here = depth_at(at);
  if (here == 0.0) return vec3(1.0);
  // Over a plane the depth value is linear on the face: a X + b Y + c, (a, b, c) the plane's normal.
  vec2 g = camera.face.xy * vec2(slope(here, depth_at(at - ivec3(1, 0, 0)), depth_at(at + ivec3(1, 0, 0))),
                                 slope(here, depth_at(at - ivec3(0, 1, 0)), depth_at(at + ivec3(0, 1, 0))));
  vec2 centre = (vec2(at.xy) - camera.face.zw) / camera.face.xy, through = (place.xy - camera.face.zw) / camera.face.xy;
  float value = here + dot(g, through - centre);
  vec3 normal = vec3(g, here - dot(g, centre));
  if (has_cube_faces(camera)) normal = from_cube_face(normal, at.z);
  vec3 p = ray * inverse_z * kNear / value;
  vec3 q = (T_lamp_camera * vec4(p, 1.0)).xyz;
  return may_shade(q) == 0.0 ? vec3(1.0) : shadow_factor(q, -normalize(mat3(T_lamp_camera) * normal), blocker);
}

void main() {
  uint item;
  if (!next_work(item)) return;
  ivec2 pixel = ivec2(item & 0xffffu, item >> 16) + ivec2(gl_LocalInvocationIndex & 3u, (gl_LocalInvocationIndex >> 2) & 3u);
  if (all(lessThan(pixel, ivec2(camera.size.xy)))) imageStore(light, pixel, vec4(factor(pixel, number_of_work(1)), 1.0));
}
#else
// What is seen at the pixel, in the lamp's frame; behind the lamp where that is nothing.
vec3 seen_at(ivec2 pixel) {
  vec3 ray, place;
  float inverse_z;
  if (!ray_through(pixel, ray) || !project_face(camera, ray, place, inverse_z)) return vec3(-1.0);
  float here = texelFetch(depth, ivec3(ivec2(floor(place.xy + 0.5)), int(place.z)), 0).r;
  return here == 0.0 ? vec3(-1.0) : (T_lamp_camera * vec4(ray * inverse_z * kNear / here, 1.0)).xyz;
}

#if STEP == 1
// The mean depth value of what may shade the pixel, or one beside it; 0: nothing.
float blocker_at(ivec2 pixel) {
  const float kBlock = 3.0;  // px of the map that a block may cover
  vec3 q = seen_at(pixel);
  float nearest = may_shade(q);
  return nearest > 0.0 ? blocker_value(q, nearest, kBlock) : 0.0;
}

void main() {
  uint item;
  if (!next_work(item)) return;
  ivec2 first = ivec2(item & 0xffffu, item >> 16), last = min(first + 3, ivec2(camera.size.xy) - 1);
  float a = blocker_at(first), b = blocker_at(last);
  if (max(a, b) == 0.0) return;
  uint i = 2u * atomicAdd(work_args[3], 1u);
  work_items[i] = item;
  work_items[i + 1u] = floatBitsToUint(min(a, b) > 0.0 ? 0.5 * (a + b) : max(a, b));
}
#else
bool may_be_shaded(ivec2 pixel) {
  return may_shade(seen_at(pixel)) > 0.0;
}

void main() {
  ivec2 first = 4 * ivec2(gl_GlobalInvocationID.xy), last = min(first + 3, ivec2(camera.size.xy) - 1);
  if (any(greaterThanEqual(first, ivec2(camera.size.xy)))) return;
  if (may_be_shaded(first) || may_be_shaded(last)) append_work(uint(first.x) | uint(first.y) << 16);
}
#endif
#endif
