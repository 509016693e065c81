// How an image shows what a pixel of a view shows. Needs camera.glsl, seen.glsl, and view.glsl's Point, Surface and
// kUncertain. Defines: HOMOGRAPHIES, as there.

// Less than this share of the view's resolution is clearly worse than what older images may have seen. Where even the
// less crowded axis has more pixels than that for one of the view, they would flicker: coarser levels of the textures
// hold means of more of them than are sampled here.
const float kCoarsest = 0.3, kFinest = 3.0;
// Models are bumpy: what stands higher above a point's surface than this share of the model's accuracy hides the point, what stands
// lower may be none, or lie elsewhere.
const float kBump = 0.25;
const float kRim = 6.0;  // px of the image within which it gives way to older ones

// How an image shows a point.
struct Sighting {
  float weight;  // beside what older images saw; 0: not at all; kUncertain: only where these saw nothing
  vec2 pixel;    // of the image
  float finer;   // pixels of the image for one of the view, on the less crowded axis
};

bool is_certain(Sighting seen) {
  return seen.weight > kUncertain;
}

// Of a point at `q` of camera `c`, the image's. `distance2`: square of its distance from the view's camera. `plane`: distance of its
// surface's plane from the image's camera; `areas`: of that from the view's. Few divisions and roots: they are what costs here.
Sighting sighting_at(int c, vec3 q, float distance2, float plane, float areas) {
  const Sighting none = Sighting(0.0, vec2(0.0), 1.0);
  vec2 pixel;
  bool certain;
  // A bump of height h, seen along a ray that the plane meets at z, is h z / plane before it.
  float unsure = depth_tolerance * min(kBump * q.z / max(plane, 1e-6), 1.0);
  if (!is_seen(c, q, unsure, pixel, certain)) return none;
  float nearer2 = distance2 / dot(q, q), nearer = sqrt(nearer2);
  vec2 finer = nearer * cameras[c].focal.xy / camera.focal.xy;
  float share2 = finer.x * finer.y * nearer * areas;  // pixels of the image for one of the view, by area
  if (share2 < kCoarsest * kCoarsest || finer.x > kFinest) return none;
  vec2 inside = min(pixel, cameras[c].size.xy - 1.0 - pixel);
  return Sighting(certain ? clamp(min(inside.x, inside.y) / kRim, 2.0 * kUncertain, 1.0) : kUncertain, pixel, finer.x);
}

Sighting sighting_of(int c, Point point) {
  int node = point.node + c * node_count;
  vec3 q = node_to_camera(node_poses, node, point.p);
  vec3 normal = rotate_to_camera(node_poses, node, point.normal), way = point.t * point.sight;
  float plane = abs(dot(normal, q));
  return sighting_at(c, q, dot(way, way), plane, plane / max(abs(dot(point.normal, way)), 1e-12));
}

Sighting sighting_of(Point point) {
  return sighting_of(0, point);
}

#if HOMOGRAPHIES
layout(binding = 8) uniform samplerBuffer homographies;

// The same, without the point. The determinant of H is how far the plane is from the one camera, of that from the other.
Sighting sighting_of(Surface shown) {
  int first = 3 * int(shown.number - 1u);
  vec4 x = texelFetch(homographies, first), y = texelFetch(homographies, first + 1), z = texelFetch(homographies, first + 2);
  float t = 1.0 / (x.w * shown.ray.x + y.w * shown.ray.y + z.w * shown.ray.z);
  vec3 q = t * vec3(dot(x.xyz, shown.ray), dot(y.xyz, shown.ray), dot(z.xyz, shown.ray));
  float areas = abs(dot(x.xyz, cross(y.xyz, z.xyz)));
  vec3 m = vec3(x.w, y.w, z.w);
  return sighting_at(0, q, t * t * dot(shown.ray, shown.ray), areas * inversesqrt(dot(m, m)), areas);
}
#endif
