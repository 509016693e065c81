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

// A page, or a tile of it, as a part of a plane: its points lie within `slack` of it (metres).
struct Part {
  vec3 middle, a, b;  // node frame: corners at middle +- a +- b
  float slack;
};

Part part_of(ChartRecord chart, vec2 middle, float half_side, float height, vec2 slope, float residual) {
  return Part(chart.origin + middle.x * chart.eu + middle.y * chart.ev + (height - 1.0) * chart.eh,
              half_side * (chart.eu + slope.x * chart.eh), half_side * (chart.ev + slope.y * chart.eh),
              residual * length(chart.eh));
}

bool may_see(int c, mat4x3 T_camera_node, Part part) {
  mat3 R = mat3(T_camera_node);
  return may_see(c, T_camera_node * vec4(part.middle, 1.0), R * part.a, R * part.b, part.slack);
}

void main() {
  int index = int(gl_WorkGroupSize.x) * first_group + int(gl_GlobalInvocationID.x);
  if (index >= page_count) return;
  uvec4 page = texelFetch(pages, 3 * index), planes01 = texelFetch(pages, 3 * index + 1),
        planes23 = texelFetch(pages, 3 * index + 2);
  ChartRecord chart = read_chart(charts, int(page.x));
  vec2 corner = 16.0 * vec2(page.y & 0xffffu, page.y >> 16);
  // Of each tile: height of its plane and residual, which is negative where nothing is there; slope.
  vec2 height_residual[4], slope[4];
  // The plane of the page's first tile, and how far the others leave it: most pages are hidden or out of view as a whole.
  vec2 page_slope = vec2(0.0);
  float page_height = 0.0, page_residual = -1.0;
  for (int tile = 0; tile < 4; ++tile) {
    uvec4 planes = tile < 2 ? planes01 : planes23;
    uvec2 plane = (tile & 1) == 0 ? planes.xy : planes.zw;
    height_residual[tile] = unpackHalf2x16(plane.x);
    slope[tile] = unpackHalf2x16(plane.y);
    if (height_residual[tile].y < 0.0) continue;
    vec2 from_middle = 8.0 * vec2(tile & 1, tile >> 1) - 4.0;
    if (page_residual < 0.0) {
      page_slope = slope[tile];
      page_height = height_residual[tile].x - dot(from_middle, page_slope);
    }
    vec2 turned = abs(slope[tile] - page_slope);
    float off = abs(height_residual[tile].x - page_height - dot(from_middle, page_slope));
    page_residual = max(page_residual, off + 3.5 * (turned.x + turned.y) + height_residual[tile].y);
  }
  uint mask = 0u;
  for (int c = 0; c < camera_count && page_residual >= 0.0; ++c) {
    int row = 3 * (c * node_count + chart.node);
    mat4x3 T = transpose(mat3x4(texelFetch(node_poses, row), texelFetch(node_poses, row + 1), texelFetch(node_poses, row + 2)));
    if (!may_see(c, T, part_of(chart, corner + 7.5, 7.5, page_height, page_slope, page_residual))) continue;
    for (int tile = 0; tile < 4; ++tile) {
      if (height_residual[tile].y < 0.0) continue;
      vec2 middle = corner + vec2(tile & 1, tile >> 1) * 8.0 + 3.5;
      Part part = part_of(chart, middle, 3.5, height_residual[tile].x, slope[tile], height_residual[tile].y);
      if (may_see(c, T, part)) mask |= 1u << (2 * tile + c);
    }
  }
  masks[index] = mask;
}
