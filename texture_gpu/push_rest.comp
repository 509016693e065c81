// Hole filling, upwards: levels 2 to 4 of a page from its level 1. One invocation a page.
#include "atlas.glsl"
#include "jobs.glsl"
layout(local_size_x = 64) in;
layout(binding = 7) uniform usamplerBuffer jobs;
layout(binding = 11) uniform sampler2DArray colours;
layout(binding = 0, r32ui) uniform writeonly uimage2DArray level2;
layout(binding = 1, r32ui) uniform writeonly uimage2DArray level3;
layout(binding = 2, r32ui) uniform writeonly uimage2DArray level4;
uniform int job_count;

// Mean of `seen` texels weighted by their share; where there are none, of the `filled` ones.
uvec4 store_form(vec4 seen, vec4 filled, float count) {
  if (seen.a > 0.0) return pack_texel(vec4(seen.rgb / seen.a, max(seen.a / count, kLeastSeen)));
  return filled.a > 0.0 ? pack_texel(vec4(filled.rgb / filled.a, kFilled)) : uvec4(0u);
}

void main() {
  int index = int(gl_GlobalInvocationID.x);
  if (index >= job_count) return;
  Job job = read_job(jobs, index);
  ivec3 from = slot_origin(job.new_slot, 1);
  vec4 seen4 = vec4(0.0);
  for (int q = 0; q < 4; ++q) {  // level 3 texel
    vec4 seen3 = vec4(0.0), filled3 = vec4(0.0);
    for (int r = 0; r < 4; ++r) {  // level 2 texel within
      ivec2 at2 = 2 * ivec2(q & 1, q >> 1) + ivec2(r & 1, r >> 1);
      vec4 seen2 = vec4(0.0), filled2 = vec4(0.0);
      for (int s = 0; s < 4; ++s) {
        vec4 c = unpack_texel(texelFetch(colours, from + ivec3(2 * at2 + ivec2(s & 1, s >> 1), 0), 1));
        seen2 += step(kSeen, c.a) * vec4(c.rgb, 1.0) * c.a;
        filled2 += step(kColoured, c.a) * vec4(c.rgb, 1.0);
      }
      imageStore(level2, slot_origin(job.new_slot, 2) + ivec3(at2, 0), store_form(seen2, filled2, 4.0));
      seen3 += seen2;
      filled3 += filled2;
    }
    imageStore(level3, slot_origin(job.new_slot, 3) + ivec3(q & 1, q >> 1, 0), store_form(seen3, filled3, 16.0));
    seen4 += seen3;
  }
  imageStore(level4, slot_origin(job.new_slot, 4), store_form(seen4, vec4(0.0), 64.0));
}
