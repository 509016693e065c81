// Lists the jobs whose pages have texels that no camera has seen.
#include "work_list.glsl"
layout(local_size_x = 64) in;
layout(binding = 10) uniform usamplerBuffer holes;
uniform int job_count;

void main() {
  int index = int(gl_GlobalInvocationID.x);
  if (index < job_count && texelFetch(holes, index).r != 0u) append_work(uint(index));
}
