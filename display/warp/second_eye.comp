// One row of the second eye's picture: see second_eye.hpp. Where the second eye is to the left, all is mirrored.
layout(local_size_x = 16) in;
layout(binding = 0) uniform sampler2D depth;    // 1/m
layout(binding = 1) uniform sampler2D picture;
layout(binding = 0, rgba8) uniform writeonly image2D second;
layout(binding = 1, r8) uniform writeonly image2D holes;
layout(std430, binding = 0) buffer Count { uint unseen; };
uniform ivec2 first_size, second_size;
uniform int rows_apart;  // row of the first - row of the second
uniform vec4 x;  // column in the second = x.x * column in the first + x.y - x.z * inverse depth
const float kSmooth = 0.02;  // as in depth_warp.comp
const float kTorn = 1.5;     // px between two neighbours of the first that are of two surfaces

int row;
bool mirrored;
uint holes_here = 0u;

void put(int column, vec4 colour, float hole) {
  ivec2 at = ivec2(mirrored ? second_size.x - 1 - column : column, row);
  imageStore(second, at, colour);
  imageStore(holes, at, vec4(hole));
  if (hole > 0.0) ++holes_here;
}

void main() {
  row = int(gl_GlobalInvocationID.x);
  if (row >= second_size.y) return;
  int from = clamp(row + rows_apart, 0, first_size.y - 1);
  mirrored = x.z < 0.0;
  float last_u = -1e9, last_q = 0.0;
  vec4 last = vec4(0.0);
  for (int i = 0; i < first_size.x; ++i) {
    int column = mirrored ? first_size.x - 1 - i : i;
    float q = texelFetch(depth, ivec2(column, from), 0).r;
    vec4 colour = texelFetch(picture, ivec2(column, from), 0);
    float u = x.x * float(column) + x.y - x.z * q;
    if (mirrored) u = float(second_size.x - 1) - u;
    bool one_surface = abs(q - last_q) <= kSmooth * max(q, last_q);
    bool torn = !one_surface && u - last_u > kTorn;
    int to = min(int(floor(u)), second_size.x - 1);
    for (int t = max(int(floor(last_u)) + 1, 0); t <= to; ++t) {
      float share = clamp((float(t) - last_u) / max(u - last_u, 1e-6), 0.0, 1.0);
      vec4 between = colour;
      float hole = 0.0;
      if (i == 0) {
        between.a = 0.0;
        hole = 1.0;
      } else if (torn) {
        bool near_end = float(t) - last_u < 0.5;
        between = near_end ? last : colour;
        hole = near_end || u - float(t) < 0.5 ? 0.0 : 128.0 / 255.0;
      } else if (one_surface) {
        between = vec4(mix(last.rgb, colour.rgb, share), share < 0.5 ? last.a : colour.a);
      } else {
        between = share < 0.5 ? last : colour;
      }
      put(t, between, hole);
    }
    last_u = u;
    last_q = q;
    last = colour;
  }
  for (int t = max(int(floor(last_u)) + 1, 0); t < second_size.x; ++t) put(t, vec4(last.rgb, 0.0), 1.0);
  atomicAdd(unseen, holes_here);
}
