// Whether a camera saw a surface point, and how sharply. Needs camera.glsl. SEEN_BLOCK, SEEN_UNIT: first binding of each
// kind, as given to SeenInputs::bind().
#ifndef SEEN_UNIT
#define SEEN_BLOCK 0
#define SEEN_UNIT 0
#endif
layout(std140, binding = SEEN_BLOCK) uniform Cameras { CameraBlock cameras[2]; };
layout(binding = SEEN_UNIT) uniform samplerBuffer node_poses;  // camera 0's nodes, then camera 1's
layout(binding = SEEN_UNIT + 1) uniform sampler2DArray depth0;  // near / z, marked beside edges
layout(binding = SEEN_UNIT + 2) uniform sampler2DArray depth1;
layout(binding = SEEN_UNIT + 3) uniform sampler2D image0;
layout(binding = SEEN_UNIT + 4) uniform sampler2D image1;
uniform int node_count;
const float kBehind = 0.05;  // share of the tolerance for what lies behind the drawn surface
uniform float depth_tolerance;  // metres: surfaces nearer to each other than this count as one

// Marks (uncertain.comp) make depths negative; those of a far side are below -1, too.
float unmarked(float near_over_z) {
  return uintBitsToFloat(floatBitsToUint(near_over_z) & 0x3fffffffu);
}

// True where `p` (camera frame) is the visible surface in camera `c` and inside its image; `pixel` is then its place there.
// `certain`: outside its uncertain edges. Within these only near sides count: of a far side the image may show what
// stands before it. A point less than `unsure` metres of depth behind what is drawn there counts, but is not certain.
bool is_seen(int c, vec3 p, float unsure, out vec2 pixel, out bool certain) {
  pixel = vec2(0.0);
  certain = false;
  vec3 place;
  float inverse_z;
  if (!project_face(cameras[c], p, place, inverse_z)) return false;
  vec2 size = cameras[c].size.zw;
  vec3 at = vec3((place.xy + 0.5) / size, place.z);
  vec4 near_over_z = c == 0 ? textureGather(depth0, at) : textureGather(depth1, at);
  // All four must be certain: beside a silhouette the nearest pixel may show what stands in front. Else it alone tells.
  certain = all(greaterThanEqual(near_over_z, vec4(0.0)));
  vec2 f = fract(place.xy);
  vec2 row = f.y < 0.5 ? near_over_z.wz : near_over_z.xy;
  float nearest = f.x < 0.5 ? row.x : row.y;
  if (!certain) near_over_z = vec4(nearest < -1.0 ? 0.0 : abs(nearest));
  // The four depths around the place bracket a surface that is seen at a grazing angle. Pixels
  // without model are left out: between an occluder and nothing lies all that it hides.
  vec4 known = mix(near_over_z, vec4(1e30), equal(near_over_z, vec4(0.0)));
  float far = min(min(known.x, known.y), min(known.z, known.w)) / kNear;
  float near = max(max(near_over_z.x, near_over_z.y), max(near_over_z.z, near_over_z.w)) / kNear;
  // z beyond the farthest by more than a part of the tolerance: hidden. What stands on a surface must
  // not paint the part of it that it covers. Before the nearest: a guard texel
  // that floats beside the surface.
  float behind = far - inverse_z, per_metre = far * inverse_z, hidden = kBehind * depth_tolerance;
  if (behind > max(hidden, unsure) * per_metre || (1.0 + depth_tolerance * inverse_z) * near < inverse_z) return false;
  certain = certain && behind <= hidden * per_metre;
#if defined(FACE_IS_IMAGE) && FACE_IS_IMAGE
  pixel = place.xy;
#else
  if (!project_lens(cameras[c], p, pixel)) return false;
#endif
  return all(greaterThanEqual(pixel, vec2(0.5))) && all(lessThanEqual(pixel, cameras[c].size.xy - 1.5));
}

// The same, but certain.
bool is_seen(int c, vec3 p, out vec2 pixel) {
  bool certain;
  bool seen = is_seen(c, p, 0.0, pixel, certain);
  return seen && certain;
}

// Pixels per texel along the two texel axes `eu`, `ev` (camera frame, metres per texel) at `p`.
mat2 footprint(int c, vec3 p, vec3 eu, vec3 ev) {
  vec2 f = cameras[c].focal.xy;
  if (lens_model(cameras[c]) == 2) {  // equidistant: pixels per radian, the same all around
    float r = length(p);
    vec3 d = p / r;
    vec3 a = (eu - d * dot(d, eu)) / r, b = (ev - d * dot(d, ev)) / r;
    vec3 x = normalize(cross(vec3(0.0, 1.0, 0.0001), d)), y = cross(d, x);
    return mat2(f * vec2(dot(a, x), dot(a, y)), f * vec2(dot(b, x), dot(b, y)));
  }
  float iz2 = 1.0 / (p.z * p.z);
  return mat2(f * (eu.xy * p.z - p.xy * eu.z) * iz2, f * (ev.xy * p.z - p.xy * ev.z) * iz2);
}
