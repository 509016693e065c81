// Which nodes may be seen beside what is drawn already: their boxes against the farthest depth of tiles.
#include "near.glsl"
layout(local_size_x = 64) in;
struct NodeBox {
  vec4 x, y, z;  // T_face_node: rows
  vec4 low, high;
  uvec4 draw;    // indices, first index, base vertex; 0: to be left out, 1: to be judged, 2: drawn already
};
struct Command { uint count, instances, first_index, base_vertex, base_instance; };
layout(binding = 0, std430) readonly buffer Nodes { NodeBox nodes[]; };
layout(binding = 1, std430) writeonly buffer Commands { Command commands[]; };
layout(binding = 2, std430) writeonly buffer Visible { uint visible[]; };
layout(binding = 0) uniform sampler2D tiles;         // least near / z of 8 x 8 px
layout(binding = 1) uniform sampler2D coarse_tiles;  // of 64 x 64 px
uniform vec4 face;  // fx fy cx cy, px
uniform ivec2 size;
uniform int count;
const float kRounding = 1.001;  // of near / z: what a rasteriser may get nearer than a corner
const int kFine = 64;           // px: larger boxes are judged by coarse tiles

bool may_be_seen(NodeBox node) {
  vec2 low = vec2(1e9), high = vec2(-1e9);
  float nearest = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    vec4 p = vec4(mix(node.low.xyz, node.high.xyz, vec3(corner & 1, (corner >> 1) & 1, corner >> 2)), 1.0);
    vec3 at = vec3(dot(node.x, p), dot(node.y, p), dot(node.z, p));
    if (at.z < 2.0 * kNear) return true;
    vec2 pixel = face.xy * at.xy / at.z + face.zw;
    low = min(low, pixel);
    high = max(high, pixel);
    nearest = max(nearest, kNear / at.z);
  }
  ivec2 first = ivec2(max(floor(low) - 1.0, vec2(0.0))), last = ivec2(min(ceil(high) + 1.0, vec2(size - 1)));
  if (any(greaterThan(first, last))) return false;
  bool fine = all(lessThan(last - first, ivec2(kFine)));
  int shift = fine ? 3 : 6;
  for (int y = first.y >> shift; y <= last.y >> shift; ++y)
    for (int x = first.x >> shift; x <= last.x >> shift; ++x) {
      float least = fine ? texelFetch(tiles, ivec2(x, y), 0).r : texelFetch(coarse_tiles, ivec2(x, y), 0).r;
      if (least <= kRounding * nearest) return true;
    }
  return false;
}

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= count) return;
  NodeBox node = nodes[i];
  uint seen = node.draw.w != 0u && may_be_seen(node) ? 1u : 0u;
  visible[i] = seen;
  commands[i] = Command(node.draw.x, node.draw.w == 1u ? seen : 0u, node.draw.y, node.draw.z, 0u);
}
