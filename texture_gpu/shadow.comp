// The factor that shadows of moving parts put on each pixel of a camera. First blocks of 4x4 pixels are listed that some
// might reach, then those of them where some do, and how near to the lamp what throws it is: where nothing is listed, nothing
// is paid. In most of these the shadow changes so little that five pixels tell the others; of the rest each is computed.
//
// Defines: STEP 0, 1, 2; the last one twice, for five pixels and for each.
#include "camera.glsl"
#define SHADOW_UNIT 3
#include "shadow.glsl"
layout(std140, binding = 0) uniform Camera { CameraBlock camera; };
layout(binding = 1) uniform sampler2DArray depth;
layout(binding = 2) uniform sampler2D rays;
uniform mat4 T_lamp_camera;
#if STEP == 2
#define INVOCATIONS_PER_ITEM 1
#define WORDS_PER_ITEM 2
layout(local_size_x = 64) in;  // a block each
#include "work_item.glsl"
#include "work_list.glsl"
layout(binding = 0, rgba8) uniform writeonly image2D light;
#elif STEP == 1
#define INVOCATIONS_PER_ITEM 1
layout(local_size_x = 64) in;  // a block each
#include "work_item.glsl"
#include "work_list.glsl"
#else
#include "work_list.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
#endif

#if STEP > 0
void append_block(uint item, float blocker) {
  uint i = 2u * atomicAdd(work_args[3], 1u);
  work_items[i] = item;
  work_items[i + 1u] = floatBitsToUint(blocker);
}
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

uniform bool each;  // of the pixels of the blocks, which are those that were listed for it
const float kBent = 0.003;               // share of its depth by which a block may differ from a plane
const float kEven = 0.15, kLinear = 0.01;  // of factors: between corners, and of the middle from their mean

// One surface, over which depth values are linear. `first`: the pixel of the block's first corner.
bool is_even(ivec2 first) {
  vec3 ray, place;
  float inverse_z;
  if (!ray_through(first, ray) || !project_face(camera, ray, place, inverse_z)) return false;
  ivec3 at = ivec3(ivec2(floor(place.xy + 0.5)), int(place.z));
  float a = depth_at(at), b = depth_at(at + ivec3(3, 0, 0)), c = depth_at(at + ivec3(0, 3, 0));
  vec2 step_of = vec2(b - a, c - a) / 3.0;
  float off = 0.0;
  for (int i = 0; i < 16; ++i) {
    ivec2 to = ivec2(i & 3, i >> 2);
    off = max(off, abs(depth_at(at + ivec3(to, 0)) - a - dot(step_of, vec2(to))));
  }
  return off <= kBent * min(a, min(b, c));
}

void main() {
  uint item;
  if (!next_work(item)) return;
  float blocker = number_of_work(1);
  ivec2 first = ivec2(item & 0xffffu, item >> 16);
  int points = each ? 16 : 5;  // a loop of unknown length is not unrolled, which would take a second to compile
  vec3 at[5];
  for (int i = 0; i < points; ++i) {
    ivec2 pixel = first + (each ? ivec2(i & 3, i >> 2) : i == 4 ? ivec2(1) : 3 * ivec2(i & 1, i >> 1));
    vec3 here = factor(pixel, blocker);
    if (!each) at[i] = here;
    if (each && all(lessThan(pixel, ivec2(camera.size.xy)))) imageStore(light, pixel, vec4(here, 1.0));
  }
  if (each) return;
  vec3 low = min(min(at[0], at[1]), min(at[2], at[3])), high = max(max(at[0], at[1]), max(at[2], at[3]));
  vec3 bent = abs(at[4] - mix(mix(at[0], at[1], 1.0 / 3.0), mix(at[2], at[3], 1.0 / 3.0), 1.0 / 3.0));
  bool is_whole = all(lessThan(first + 3, ivec2(camera.size.xy)));
  if (is_whole && all(lessThan(high - low, vec3(kEven))) && all(lessThan(bent, vec3(kLinear))) && is_even(first)) {
    for (int i = 0; i < 16; ++i) {
      ivec2 to = ivec2(i & 3, i >> 2);
      vec2 f = vec2(to) / 3.0;
      imageStore(light, first + to, vec4(mix(mix(at[0], at[1], f.x), mix(at[2], at[3], f.x), f.y), 1.0));
    }
    return;
  }
  append_block(item, blocker);
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
  append_block(item, min(a, b) > 0.0 ? 0.5 * (a + b) : max(a, b));
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
