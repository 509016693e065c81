// Which tiles of which pages may be seen by which camera. Conservative: a tile that is seen is
// never dropped. One invocation a page; eight bits a page: bit 2 * tile + camera.
#include "camera.glsl"
#include "chart_record.glsl"
layout(local_size_x = 64) in;
layout(std140, binding = 0) uniform Cameras { CameraBlock cameras[2]; };
layout(binding = 0) uniform samplerBuffer node_poses;
layout(binding = 1) uniform sampler2DArray blocks0;
layout(binding = 2) uniform sampler2DArray blocks1;
layout(binding = 3) uniform usamplerBuffer pages;  // chart, x | y << 16, lowest | highest raw height << 16, height slot
layout(binding = 4) uniform samplerBuffer charts;
layout(binding = 0, std430) writeonly buffer Masks { uint masks[]; };
uniform int page_count;
uniform int camera_count;
uniform int node_count;
uniform float depth_tolerance;

const int kMostBlocks = 8;  // a sphere over more blocks than this a side counts as visible

bool may_see(int c, vec3 p, float radius) {
  float nearest = p.z - radius;
  bool cube = cameras[c].tone.w > 1.5;
  if (!cube && p.z + radius < kNear) return false;
  vec3 place;
  float inverse_z;
  bool on_face = project_face(cameras[c], p, place, inverse_z);
  if (cube) nearest = 1.0 / inverse_z - radius;
  if (nearest < kNear) return true;
  // A sphere's outline reaches beyond f r / z off the axis: 1 / cos of the viewing angle covers it.
  float reach = max(cameras[c].face.x, cameras[c].face.y) * radius / nearest * length(p) * abs(inverse_z) + 1.5;
  vec2 size = cameras[c].size.zw;
  if (any(lessThan(place.xy, vec2(-reach))) || any(greaterThan(place.xy, size + reach))) return cube;
  if (cube && (any(lessThan(place.xy, vec2(reach))) || any(greaterThan(place.xy, size - reach)))) return true;
  ivec2 last = (ivec2(size) + 3) / 4 - 1;
  ivec2 from = clamp(ivec2(floor((place.xy - reach) / 4.0)), ivec2(0), last);
  ivec2 to = clamp(ivec2(floor((place.xy + reach) / 4.0)), ivec2(0), last);
  if (any(greaterThanEqual(to - from, ivec2(kMostBlocks)))) return true;
  float threshold = 1.0 / max(nearest - depth_tolerance, kNear);
  for (int y = from.y; y <= to.y; ++y)
    for (int x = from.x; x <= to.x; ++x) {
      ivec3 at = ivec3(x, y, int(place.z));
      float farthest = c == 0 ? texelFetch(blocks0, at, 0).x : texelFetch(blocks1, at, 0).x;
      if (farthest < threshold) return true;  // holes are negative: they hide nothing
    }
  return false;
}

void main() {
  int index = int(gl_GlobalInvocationID.x);
  if (index >= page_count) return;
  uvec4 page = texelFetch(pages, index);
  ChartRecord chart = read_chart(charts, int(page.x));
  vec2 corner = 16.0 * vec2(page.y & 0xffffu, page.y >> 16);
  float low = float(page.z & 0xffffu) - 1.0, high = float(page.z >> 16) - 1.0;
  float radius = length(vec2(5.0 * (length(chart.eu) + length(chart.ev)) * 0.70711, 0.5 * (high - low) * length(chart.eh)));
  uint mask = 0u;
  for (int tile = 0; tile < 4; ++tile) {
    vec2 middle = corner + vec2(tile & 1, tile >> 1) * 8.0 + 3.5;
    vec3 p_node = chart.origin + middle.x * chart.eu + middle.y * chart.ev + 0.5 * (low + high) * chart.eh;
    for (int c = 0; c < camera_count; ++c) {
      vec3 p = node_to_camera(node_poses, c * node_count + chart.node, p_node);
      if (may_see(c, p, radius)) mask |= 1u << (2 * tile + c);
    }
  }
  masks[index] = mask;
}
