// Scatters the heights of new pages into their slots. One work group a page; staged row-major.
#include "atlas.glsl"
layout(local_size_x = 16, local_size_y = 16) in;
layout(binding = 7) uniform usamplerBuffer staged;  // 256 raw heights a page
layout(binding = 8) uniform usamplerBuffer slots;
layout(binding = 0, r16ui) uniform writeonly uimage2DArray heights;

void main() {
  int page = int(gl_WorkGroupID.x);
  ivec2 at = ivec2(gl_LocalInvocationID.xy);
  uint raw = texelFetch(staged, page * 256 + at.y * 16 + at.x).r;
  imageStore(heights, slot_origin(texelFetch(slots, page).r, 0) + ivec3(at, 0), uvec4(raw));
}
