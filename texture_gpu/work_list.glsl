// A list that one dispatch fills and the next works off. Header: two sets of indirect arguments
// that differ in x only, and the count. C++ side: work_list.hpp.
layout(binding = 1, std430) buffer WorkList { uint work_args[8]; uint work_items[]; };

const uint kMostGroups = 65535u;

#ifndef ITEMS_PER_GROUP
#define ITEMS_PER_GROUP 1
#endif

void append_work(uint item) {
  uint index = atomicAdd(work_args[3], 1u);
  work_items[index] = item;
  uint group = index / ITEMS_PER_GROUP;
  uint y = min(group + 1u, kMostGroups), z = group / kMostGroups + 1u;
  atomicMax(work_args[1], y);
  atomicMax(work_args[5], y);
  atomicMax(work_args[2], z);
  atomicMax(work_args[6], z);
}
