// Lists the jobs whose pages have texels that no camera has seen. What was filled before stays
// filled when a page moves; of pages without new holes every REFRESH-th is refilled, so that fills
// follow the colours around them within a few images.
#include "work_list.glsl"
layout(local_size_x = 64) in;
layout(binding = 10) uniform usamplerBuffer holes;
layout(binding = 7) uniform usamplerBuffer jobs;
uniform int job_count;
uniform int turn;     // of this image
uniform int refresh;  // images until every page had its turn; 1: all pages now

void main() {
  int index = int(gl_GlobalInvocationID.x);
  if (index >= job_count) return;
  uint hole = texelFetch(holes, index).r;
  int table_index = int(texelFetch(jobs, 2 * index + 1).y);
  if (hole == 3u || (hole != 0u && (table_index + turn) % refresh == 0)) append_work(uint(index));
}
