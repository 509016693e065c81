// What an image that is kept shows of a point, beside the newest one: part of view.glsl. Camera 0 is that image's, camera 1
// the newest one's. The more like the eye's its direction is than the newest one's, the more of it.
layout(binding = 23) uniform sampler2D still;  // PublishedImage::still of the newest image
uniform float age;    // s, beside the newest image
uniform float claim;  // of a pixel, at most: what shares its place with others

const float kPerSecond = 0.03;  // rad: what an image is worse for each second of its age (image_choice.cpp)
const float kBetter = 0.01;     // rad: from so much on it has the whole pixel
const float kAsSharp = 0.75, kBlurred = 0.5;  // of the newest image's resolution
const float kRounding = 1e-3;    // s
const float kLonger = 0.97, kWhite = 0.98;

// Angle between what the eye and camera c look along, where they meet.
float angle_to_eye(int c, Point point) {
  int node = 3 * (point.node + c * node_count);
  vec3 q = node_to_camera(node_poses, point.node + c * node_count, point.p);
  vec3 sight = texelFetch(node_poses, node).xyz * q.x + texelFetch(node_poses, node + 1).xyz * q.y +
               texelFetch(node_poses, node + 2).xyz * q.z;
  return length(cross(normalize(sight), normalize(point.sight)));
}

// Whether the surface has looked as it does since before the older image was taken, all around the pixel of the newest.
bool is_still(vec2 newest) {
  vec4 since = textureGather(still, (newest + 0.5) / (2.0 * vec2(textureSize(still, 0))));
  return all(greaterThan(since, vec4(age - kRounding)));
}

vec4 kept_colour(Point point) {
  Sighting older = sighting_of(0, point), newest = sighting_of(1, point);
  vec2 size = cameras[0].size.xy;
  vec4 scaled = sample_for_view(older.pixel, ivec2(size), sharp_for(older.finer), older.finer);
  // What is white in a longer exposure than the one shown may be of any brightness there.
  bool is_known = cameras[0].tone.x > kLonger || max(scaled.r, max(scaled.g, scaled.b)) < kWhite;
  float better = angle_to_eye(1, point) - angle_to_eye(0, point) - kPerSecond * age;
  float sharpness = older.finer / newest.finer;
  float weight = claim * older.weight * clamp(better / kBetter, 0.0, 1.0) *
                 clamp((sharpness - kBlurred) / (kAsSharp - kBlurred), 0.0, 1.0);
  if (!is_certain(older) || !is_certain(newest) || !is_known || !is_still(newest.pixel)) weight = 0.0;
  vec3 colour = unscaled(scaled) * without_vignetting(cameras[0].tone, older.pixel, size);
  return vec4(min(cameras[0].tone.x * colour * pixel_light, vec3(1.0)), weight);
}
