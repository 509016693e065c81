// Hole filling, upwards: each texel of level 1 is the mean of the seen texels among its four; where
// there are none, of those filled for an earlier image. One work group a page.
#include "atlas.glsl"
#include "jobs.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 7) uniform usamplerBuffer jobs;
layout(binding = 11) uniform sampler2DArray colours;
layout(binding = 0, r32ui) uniform writeonly uimage2DArray level1;
uniform int first_group;

void main() {
  Job job = read_job(jobs, first_group + int(gl_WorkGroupID.x));
  ivec2 at = ivec2(gl_LocalInvocationID.xy);
  ivec3 from = slot_origin(job.new_slot, 0) + ivec3(2 * at, 0);
  vec4 seen = vec4(0.0), all = vec4(0.0);
  for (int i = 0; i < 4; ++i) {
    vec4 c = unpack_texel(texelFetch(colours, from + ivec3(i & 1, i >> 1, 0), 0));
    seen += step(kSeen, c.a) * vec4(c.rgb, 1.0);
    all += step(kColoured, c.a) * vec4(c.rgb, 1.0);
  }
  // Alpha: the share of seen texels, or that of filled colours.
  vec4 mean = seen.a > 0.0  ? vec4(seen.rgb / seen.a, seen.a / 4.0)
              : all.a > 0.0 ? vec4(all.rgb / all.a, kFilled)
                            : vec4(0.0);
  imageStore(level1, slot_origin(job.new_slot, 1) + ivec3(at, 0), pack_texel(mean));
}
