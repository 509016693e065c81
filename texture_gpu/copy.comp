// Carries tiles that no camera sees from a page's old place to its new one. A work group a tile.
#include "atlas.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 7) uniform usamplerBuffer jobs;
layout(binding = 10) uniform usamplerBuffer tiles;  // job << 4 | tile << 2
layout(binding = 11) uniform sampler2DArray old_colours;
layout(binding = 0, r32ui) uniform writeonly uimage2DArray colours;
#include "holes.glsl"
layout(binding = 9) uniform usampler2DArray heights;
uniform int first_group;

void main() {
  uint tile = texelFetch(tiles, first_group + int(gl_WorkGroupID.x)).r;
  int job = int(tile >> 4);
  uvec4 a = texelFetch(jobs, 2 * job);
  ivec2 in_page = ivec2(gl_LocalInvocationID.xy) + 8 * ivec2((tile >> 2) & 1u, (tile >> 3) & 1u);
  vec4 texel = a.z == kNoSlot ? vec4(0.0) : texelFetch(old_colours, slot_origin(a.z & 0xffffffu, 0) + ivec3(in_page, 0), 0);
  uint raw = texelFetch(heights, slot_origin(texelFetch(jobs, 2 * job + 1).x, 0) + ivec3(in_page, 0), 0).r;
  if (raw == 0u) texel = vec4(0.0);  // re-levelling may have reached beyond the surface
  float alpha = unpack_texel(texel).a;
  note_hole(int(tile >> 2), raw, alpha, alpha);
  imageStore(colours, slot_origin(a.w, 0) + ivec3(in_page, 0), uvec4(packUnorm4x8(texel)));
}
