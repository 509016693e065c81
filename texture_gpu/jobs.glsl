// One page to be written, two texels of the usamplerBuffer `jobs`.
// C++ side: PageJob in texture_gpu/chart_atlas.hpp.
struct Job {
  int chart;
  ivec2 page;        // within the chart
  uint old_slot;     // colours so far, kNoSlot: none
  uint new_slot;     // where the new colours go; may be old_slot while that is not published
  uint height_slot;
  int table_index;   // in the page table
  uint covered;      // texels of the page that lie on the surface
};

Job read_job(usamplerBuffer jobs, int index) {
  uvec4 a = texelFetch(jobs, 2 * index), b = texelFetch(jobs, 2 * index + 1);
  return Job(int(a.x), ivec2(a.y & 0xffffu, a.y >> 16), a.z, a.w, b.x, int(b.y), b.z);
}
