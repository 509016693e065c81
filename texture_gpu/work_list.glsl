// A list that one dispatch fills and the next works off. Header: two sets of indirect arguments
// that differ in x only, and the count. C++ side: work_list.hpp.
layout(binding = 1, std430) buffer WorkList { uint work_args[8]; uint work_items[]; };

const uint kMostGroups = 65535u;

void append_work(uint item) {
  uint index = atomicAdd(work_args[3], 1u);
  work_items[index] = item;
  uint y = min(index + 1u, kMostGroups), z = index / kMostGroups + 1u;
  atomicMax(work_args[1], y);
  atomicMax(work_args[5], y);
  atomicMax(work_args[2], z);
  atomicMax(work_args[6], z);
}
