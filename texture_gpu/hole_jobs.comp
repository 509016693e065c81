// Lists the jobs whose pages are to be filled (TILES 0), or their tiles with holes (TILES 1): those with texels that no camera has seen, but also
// some that one has; a page without any shows the means of the pages around it. What was filled
// before stays filled when a page moves: of pages on which nothing new was seen every REFRESH-th is
// refilled, so that fills follow the colours around them within a few images.
#include "atlas.glsl"
#include "jobs.glsl"
#include "work_list.glsl"
layout(local_size_x = 64) in;
layout(binding = 10) uniform usamplerBuffer holes;
layout(binding = 11) uniform sampler2DArray colours;
layout(binding = 7) uniform usamplerBuffer jobs;
uniform int job_count;
uniform int turn;     // of this image
uniform int refresh;  // images until every page had its turn; 1: all pages now

void main() {
  int index = int(gl_GlobalInvocationID.x);
#if TILES
  int job_index = index >> 2;
#else
  int job_index = index;
#endif
  if (job_index >= job_count) return;
  uint hole = 0u;
  for (int tile = 0; tile < 4; ++tile) hole |= texelFetch(holes, 4 * job_index + tile).r;
  Job job = read_job(jobs, job_index);
  bool has_colour = unpack_texel(texelFetch(colours, slot_origin(job.new_slot, 4), 4)).a > 0.0;
  bool changed = (hole & 6u) != 0u || (job.table_index + turn) % refresh == 0;
#if TILES
  hole = texelFetch(holes, index).r;
#endif
  if ((hole & 1u) != 0u && has_colour && changed) append_work(uint(index));
}
