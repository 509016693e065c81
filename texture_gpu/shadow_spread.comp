// The largest of the cells within reach, along one direction.
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2D before;
layout(binding = 0, r32f) uniform writeonly image2D after;
uniform ivec2 along;
uniform int reach;

void main() {
  ivec2 cell = ivec2(gl_GlobalInvocationID.xy), last = textureSize(before, 0) - 1;
  float largest = 0.0;
  for (int i = -reach; i <= reach; ++i) largest = max(largest, texelFetch(before, clamp(cell + i * along, ivec2(0), last), 0).r);
  imageStore(after, cell, vec4(largest));
}
