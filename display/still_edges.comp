// Edges as the newest image has them. Beside a step of depth images are not trusted (uncertain.comp): a small error of the camera's
// pose paints one side with the other. Where an image was taken from where the view looks from, and both sides stand where they
// stood, such an error moves the edge as a whole, and the image shows all around it what the view is to show.
//
// One invocation a pixel of the 4x4 tiles that may hold silhouettes (silhouettes.comp); camera 0 is the newest image's.
#define INVOCATIONS_PER_ITEM 16
#define WORK_UNIT 5
layout(local_size_x = 64) in;
#include "work_item.glsl"
#include "view.glsl"

layout(binding = 11) uniform sampler2DArray view_depth;  // near / z of the view's faces
uniform mat4 T_view_image;  // of what stands still
uniform float parallax;     // px of the image, for a difference of 1 in near / z

const float kMostParallax = 0.5;  // px, of one side beside the other
const float kStill = 1e-3;        // of a point's distance: what moved more did not stand still
// Around a place of the image, px: as far as errors of poses may reach.
const int kAround = 8;
const vec2 kRing[kAround] = vec2[](vec2(2, 0), vec2(-2, 0), vec2(0, 2), vec2(0, -2), vec2(1.5, 1.5), vec2(-1.5, 1.5), vec2(1.5, -1.5),
                                   vec2(-1.5, -1.5));

bool is_one_of(vec4 near_over_z, float wanted) {
  return any(lessThanEqual(abs(near_over_z - wanted), vec4(depth_tolerance / kNear * wanted * wanted)));
}

// Whether the view shows at its place what the image shows at a pixel of its faces.
bool stands_there(ivec3 at, float near_over_z) {
  vec3 way = vec3((vec2(at.xy) - cameras[0].face.zw) / cameras[0].face.xy, 1.0);
  if (has_cube_faces(cameras[0])) way = from_cube_face(way, at.z);
  vec4 p = near_over_z > 0.0 ? vec4(way * (kNear / near_over_z), 1.0) : vec4(way, 0.0);
  vec3 place;
  float inverse_z;
  if (!project_face(camera, (T_view_image * p).xyz, place, inverse_z)) return false;
  return is_one_of(textureGather(view_depth, vec3((place.xy + 0.5) / camera.size.zw, place.z)), near_over_z > 0.0 ? kNear * inverse_z : 0.0);
}

// Whether the image shows around the place of a point what the view shows there. `p`: the point, in the image's camera.
bool stands_still(vec3 p, out vec2 pixel) {
  pixel = vec2(0.0);
  vec3 place;
  float inverse_z;
  if (!project_face(cameras[0], p, place, inverse_z)) return false;
  vec2 size = cameras[0].size.zw;
  vec4 around = textureGather(depth0, vec3((place.xy + 0.5) / size, place.z));
  for (int i = 0; i < 4; ++i) around[i] = unmarked(around[i]);
  float here = kNear * inverse_z;
  bool stands = is_one_of(around, here);
  for (int i = 0; i < kAround; ++i) {
    ivec2 at = ivec2(floor(place.xy + kRing[i] + 0.5));
    bool inside = all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, ivec2(size)));
    float near_over_z = unmarked(texelFetch(depth0, ivec3(clamp(at, ivec2(0), ivec2(size) - 1), int(place.z)), 0).r);
    stands = stands && inside && abs(near_over_z - here) * parallax < kMostParallax && stands_there(ivec3(at, place.z), near_over_z);
  }
#if defined(FACE_IS_IMAGE) && FACE_IS_IMAGE
  pixel = place.xy;
#else
  stands = project_lens(cameras[0], p, pixel) && stands;
#endif
  return stands && all(greaterThanEqual(pixel, vec2(kRim))) && all(lessThanEqual(pixel, cameras[0].size.xy - 1.0 - kRim));
}

void main() {
  uint tile;
  if (!next_work(tile)) return;
  ivec2 pixel = ivec2(tile & 0xffffu, tile >> 16) + ivec2(gl_LocalInvocationIndex & 3u, (gl_LocalInvocationIndex >> 2) & 3u);
  Point point;
  if (any(greaterThanEqual(pixel, ivec2(camera.size.xy))) || !find_point(pixel, point)) return;
  vec3 ray;
  ray_through(pixel, ray);
  vec3 p = node_to_camera(node_poses, point.node, point.p), shown = point.t * ray;
  vec2 at;
  bool stood = distance((T_view_image * vec4(p, 1.0)).xyz, shown) < kStill * length(shown);
  if (!stood || !stands_still(p, at)) return;
  float finer = cameras[0].focal.x / camera.focal.x;
  float alpha = max(imageLoad(picture, pixel).a, kFromEdge);  // what was of this surface for sure still is
  imageStore(picture, pixel, vec4(image_colour(Sighting(1.0, at, finer)).rgb, alpha));
}
