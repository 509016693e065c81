// Hole filling, upwards: levels 2 to 4 of a page from its level 1. One invocation a page.
#include "atlas.glsl"
#include "jobs.glsl"
layout(local_size_x = 64) in;
layout(binding = 7) uniform usamplerBuffer jobs;
layout(binding = 11) uniform sampler2DArray colours;
layout(binding = 0, rgba8) uniform writeonly image2DArray level2;
layout(binding = 1, rgba8) uniform writeonly image2DArray level3;
layout(binding = 2, rgba8) uniform writeonly image2DArray level4;
uniform int job_count;

// Premultiplied mean of up to four values; a share that is not zero stays visible in eight bits.
vec4 store_form(vec4 sum, float count) {
  return sum.a > 0.0 ? vec4(sum.rgb / sum.a, max(sum.a / count, 2.0 / 255.0)) : vec4(0.0);
}

void main() {
  int index = int(gl_GlobalInvocationID.x);
  if (index >= job_count) return;
  Job job = read_job(jobs, index);
  ivec3 from = slot_origin(job.new_slot, 1);
  vec4 sum4 = vec4(0.0);
  for (int q = 0; q < 4; ++q) {  // level 3 texel
    vec4 sum3 = vec4(0.0);
    for (int r = 0; r < 4; ++r) {  // level 2 texel within
      ivec2 at2 = 2 * ivec2(q & 1, q >> 1) + ivec2(r & 1, r >> 1);
      vec4 sum2 = vec4(0.0);
      for (int s = 0; s < 4; ++s) {
        vec4 c = texelFetch(colours, from + ivec3(2 * at2 + ivec2(s & 1, s >> 1), 0), 1);
        sum2 += vec4(c.rgb * c.a, c.a);
      }
      imageStore(level2, slot_origin(job.new_slot, 2) + ivec3(at2, 0), store_form(sum2, 4.0));
      sum3 += sum2;
    }
    imageStore(level3, slot_origin(job.new_slot, 3) + ivec3(q & 1, q >> 1, 0), store_form(sum3, 16.0));
    sum4 += sum3;
  }
  imageStore(level4, slot_origin(job.new_slot, 4), store_form(sum4, 64.0));
}
