// Of each 8x8 pixels of the map of what moves the nearest: the largest depth value. One invocation a cell.
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2DArray depth;
layout(binding = 0, r32f) uniform writeonly image2D cells;

void main() {
  ivec2 cell = ivec2(gl_GlobalInvocationID.xy);
  float largest = 0.0;
  for (int i = 0; i < 64; ++i) largest = max(largest, texelFetch(depth, ivec3(8 * cell + ivec2(i & 7, i >> 3), 0), 0).r);
  imageStore(cells, cell, vec4(largest));
}
