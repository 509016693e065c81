// Which tiles of which pages may be seen by which camera. Conservative: a tile that is seen is
// never dropped. One invocation a page; eight bits a page: bit 2 * tile + camera.
#include "camera.glsl"
#include "chart_record.glsl"
layout(local_size_x = 64) in;
layout(std140, binding = 0) uniform Cameras { CameraBlock cameras[2]; };
layout(binding = 0) uniform samplerBuffer node_poses;
layout(binding = 1) uniform sampler2DArray blocks0;
layout(binding = 2) uniform sampler2DArray blocks1;
layout(binding = 3) uniform usamplerBuffer pages;  // three texels a page: PageRecord in chart_atlas.hpp
layout(binding = 4) uniform samplerBuffer charts;
layout(binding = 0, std430) writeonly buffer Masks { uint masks[]; };
uniform int first_group, page_count;
uniform int camera_count;
uniform int node_count;
uniform float depth_tolerance;

const int kMostBlocks = 16;  // a tile over more blocks than this a side counts as visible

// A parallelogram around p, its corners at p +- a +- b, all within `slack` of the surface (camera frame, metres).
bool may_see(int c, vec3 p, vec3 a, vec3 b, float slack) {
  vec3 reach3 = abs(a) + abs(b) + slack;
  bool cube = has_cube_faces(cameras[c]);
  float nearest = p.z - reach3.z;
  if (!cube && p.z + reach3.z < kNear) return false;
  vec3 place;
  float inverse_z;
  bool on_face = project_face(cameras[c], p, place, inverse_z);
  vec2 low, high;
  if (cube) {
    // Faces change from place to place: a sphere serves all of them. Its outline reaches beyond
    // f r / z off the axis: 1 / cos of the viewing angle covers it.
    float radius = length(a) + length(b) + slack;
    nearest = 1.0 / inverse_z - radius;
    if (nearest < kNear) return true;
    float reach = cameras[c].face.x * radius / nearest * length(p) * abs(inverse_z);
    low = place.xy - reach;
    high = place.xy + reach;
  } else {
    if (nearest < kNear) return true;
    low = high = place.xy;
    for (int corner = 0; corner < 4; ++corner) {
      vec3 q = p + ((corner & 1) != 0 ? a : -a) + ((corner & 2) != 0 ? b : -b);
      vec2 pixel = cameras[c].face.xy * q.xy / q.z + cameras[c].face.zw;
      low = min(low, pixel);
      high = max(high, pixel);
    }
    // The slack moves the surface along its normal by `slack`; seen from anywhere that is at most this.
    float swell = max(cameras[c].face.x, cameras[c].face.y) * slack / nearest * (1.0 + length(p.xy) / p.z);
    low -= swell;
    high += swell;
  }
  low -= 1.5;  // the extraction asks the four pixels around a place
  high += 1.5;
  vec2 size = cameras[c].size.zw;
  if (any(lessThan(high, vec2(0.0))) || any(greaterThan(low, size))) return cube;
  if (cube && (any(lessThan(low, vec2(0.0))) || any(greaterThan(high, size)))) return true;
  ivec2 last = (ivec2(size) + 3) / 4 - 1;
  ivec2 from = clamp(ivec2(floor(low / 4.0)), ivec2(0), last);
  ivec2 to = clamp(ivec2(floor(high / 4.0)), ivec2(0), last);
  if (any(greaterThanEqual(to - from, ivec2(kMostBlocks)))) return true;
  // Where the tile lies in front of the farthest surface of some block, it may be seen. Its plane is
  // linear in 1/z over a face: sharper than the tile's nearest point, where it is seen at an angle.
  vec3 n = cross(a, b);
  float distance = dot(n, p);
  vec2 slope = n.xy / (cameras[c].face.xy * distance);  // of 1/z, per pixel
  float offset = (n.z - dot(n.xy / cameras[c].face.xy, cameras[c].face.zw)) / distance;
  float along_ray = slack * length(n) * length(p) / (p.z * max(abs(distance) / p.z, 1e-9));
  bool plane = !cube && abs(distance) > 1e-6 * length(n) * length(p);
  vec2 block_size = 1.0 / vec2(last + 1);
  for (int y = from.y; y <= to.y; ++y)
    for (int x = from.x; x <= to.x; ++x) {
      // Sampling the nearest texel is far cheaper on software renderers than fetching it.
      vec3 at = vec3((vec2(x, y) + 0.5) * block_size, place.z);
      float farthest = c == 0 ? textureLod(blocks0, at, 0.0).x : textureLod(blocks1, at, 0.0).x;
      vec2 first = max(4.0 * vec2(x, y) - 0.5, low), end = min(4.0 * vec2(x, y) + 3.5, high);
      float largest = dot(slope, 0.5 * (first + end)) + offset + dot(abs(slope), 0.5 * max(end - first, vec2(0.0)));
      float z = plane && largest > 0.0 ? max(1.0 / largest - along_ray, nearest) : nearest;
      if (farthest * max(z - depth_tolerance, kNear) < 1.0) return true;  // holes are negative: they hide nothing
    }
  return false;
}

void main() {
  int index = 64 * first_group + int(gl_GlobalInvocationID.x);
  if (index >= page_count) return;
  uvec4 page = texelFetch(pages, 3 * index), planes01 = texelFetch(pages, 3 * index + 1),
        planes23 = texelFetch(pages, 3 * index + 2);
  ChartRecord chart = read_chart(charts, int(page.x));
  vec2 corner = 16.0 * vec2(page.y & 0xffffu, page.y >> 16);
  mat4x3 T_camera_node[2];
  for (int c = 0; c < camera_count; ++c) {
    int row = 3 * (c * node_count + chart.node);
    T_camera_node[c] = transpose(mat3x4(texelFetch(node_poses, row), texelFetch(node_poses, row + 1), texelFetch(node_poses, row + 2)));
  }
  uint mask = 0u;
  for (int tile = 0; tile < 4; ++tile) {
    uvec4 planes = tile < 2 ? planes01 : planes23;
    uvec2 plane = (tile & 1) == 0 ? planes.xy : planes.zw;
    vec2 center_residual = unpackHalf2x16(plane.x), slope = unpackHalf2x16(plane.y);
    if (center_residual.y < 0.0) continue;
    vec2 middle = corner + vec2(tile & 1, tile >> 1) * 8.0 + 3.5;
    vec3 p_node = chart.origin + middle.x * chart.eu + middle.y * chart.ev + (center_residual.x - 1.0) * chart.eh;
    vec3 a_node = 3.5 * (chart.eu + slope.x * chart.eh), b_node = 3.5 * (chart.ev + slope.y * chart.eh);
    float slack = center_residual.y * length(chart.eh);
    for (int c = 0; c < camera_count; ++c) {
      mat4x3 T = T_camera_node[c];
      vec3 p = T * vec4(p_node, 1.0), a = mat3(T) * a_node, b = mat3(T) * b_node;
      if (may_see(c, p, a, b, slack)) mask |= 1u << (2 * tile + c);
    }
  }
  masks[index] = mask;
}
