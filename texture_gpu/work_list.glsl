// A list that one dispatch fills and the next works off. Header: the indirect arguments, completed
// by work_args.comp, and the count. C++ side: work_list.hpp.
layout(binding = 1, std430) buffer WorkList { uint work_args[4]; uint work_items[]; };

void append_work(uint item) {
  work_items[atomicAdd(work_args[3], 1u)] = item;
}
