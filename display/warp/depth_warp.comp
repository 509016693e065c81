// What each pixel of the target sees, found in the source: see depth_warp.hpp.
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2DArray depth;  // near / z, 0 where no model is
layout(binding = 1) uniform sampler2D picture;
layout(binding = 2) uniform sampler2D reach;
layout(binding = 0, rgba8) uniform writeonly image2D warped;
layout(binding = 1, r8) uniform writeonly image2D holes;
uniform vec4 source_lens, target_lens;  // fx fy cx cy, px
uniform ivec2 source_size, target_size;
uniform vec4 r0, r1, r2;  // T_source_target: rows of its rotation, and its translation
uniform vec4 back;        // third row of the inverse's rotation; its product with the translation
const float kNear = 0.01;       // gl::kNearPlane
const int kMostSteps = 24;
const float kHit = 0.75;        // px: closer than that, the surface is the pixel's
const float kSmooth = 0.02;     // relative difference of depth beyond which two pixels are of two surfaces

vec3 base, along;  // of the ray: source = base + along * inverse target depth

vec2 place(float w) {
  vec3 p = base + along * w;
  return source_lens.xy * p.xy / max(p.z, 1e-6) + source_lens.zw;
}

// Inverse target depth of the surface that the source shows at a pixel of inverse depth q.
float surface(vec2 at, float q) {
  vec3 ray = vec3((at - source_lens.zw) / source_lens.xy, 1.0);
  return q / max(dot(back.xyz, ray) - q * back.w, 1e-6);
}

float depth_at(vec2 at) {
  ivec2 p = clamp(ivec2(floor(at + 0.5)), ivec2(0), source_size - 1);
  return texelFetch(depth, ivec3(p, 0), 0).r / kNear;
}

// Between its four neighbours where they are of one surface; else the nearest one's.
vec4 colour_at(vec2 at) {
  vec2 first = floor(at);
  vec4 q = vec4(depth_at(first), depth_at(first + vec2(1, 0)), depth_at(first + vec2(0, 1)), depth_at(first + vec2(1)));
  float most = max(max(q.x, q.y), max(q.z, q.w)), least = min(min(q.x, q.y), min(q.z, q.w));
  vec2 from = most - least <= kSmooth * most ? at : floor(at + 0.5);
  ivec2 p = ivec2(floor(from));
  vec2 t = from - vec2(p);
  ivec2 high = source_size - 1;
  vec4 a = texelFetch(picture, clamp(p, ivec2(0), high), 0), b = texelFetch(picture, clamp(p + ivec2(1, 0), ivec2(0), high), 0);
  if (t == vec2(0.0)) return a;
  vec4 c = texelFetch(picture, clamp(p + ivec2(0, 1), ivec2(0), high), 0), d = texelFetch(picture, clamp(p + 1, ivec2(0), high), 0);
  vec4 mixed = mix(mix(a, b, t.x), mix(c, d, t.x), t.y);
  mixed.a = texelFetch(picture, clamp(ivec2(floor(at + 0.5)), ivec2(0), high), 0).a;
  return mixed;
}

bool inside(vec2 at) {
  return all(greaterThanEqual(at, vec2(-0.5))) && all(lessThan(at, vec2(source_size) - 0.5));
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, target_size))) return;
  vec3 ray = vec3((vec2(pixel) - target_lens.zw) / target_lens.xy, 1.0);
  base = vec3(dot(r0.xyz, ray), dot(r1.xyz, ray), dot(r2.xyz, ray));
  along = vec3(r0.w, r1.w, r2.w);

  vec2 far_away = place(0.0);
  ivec2 block = clamp(ivec2(floor(far_away + 0.5)), ivec2(0), source_size - 1) / 16;
  vec2 both = texelFetch(reach, block, 0).rg / kNear;
  float nearest = surface(far_away, both.r) * 1.02, farthest = surface(far_away, both.g) * 0.98;
  float way = length(place(nearest) - place(farthest));
  int steps = clamp(int(ceil(way)), 1, kMostSteps);

  float found = -1.0, background = 1e30;
  vec2 found_at = vec2(0.0), background_at = place(farthest);
  for (int i = 0; i <= steps; ++i) {
    float w = mix(nearest, farthest, float(i) / float(steps));
    vec2 at = place(w);
    float here = surface(at, depth_at(at));
    if (here < background) {
      background = here;
      background_at = at;
    }
    if (here < w && i < steps) continue;  // the ray is still in front of it
    // Two steps towards where the ray meets this very surface.
    vec2 closer = place(here);
    float there = surface(closer, depth_at(closer));
    closer = place(there);
    float again = surface(closer, depth_at(closer));
    if (length(place(again) - closer) < kHit) {
      found = again;
      found_at = place(again);
      break;
    }
  }

  bool is_found = found >= 0.0;
  vec2 at = is_found ? found_at : background_at;
  bool is_inside = inside(at);
  imageStore(warped, pixel, is_inside ? colour_at(at) : vec4(colour_at(clamp(at, vec2(0.0), vec2(source_size - 1))).rgb, 0.0));
  imageStore(holes, pixel, vec4(is_inside ? (is_found ? 0.0 : 128.0 / 255.0) : 1.0));
}
