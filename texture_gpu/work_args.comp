// Turns the length of a work list into the arguments of the dispatch that works it off.
#include "work_list.glsl"
layout(local_size_x = 1) in;
uniform uint items_per_group;
const uint kMostGroups = 65535u;

void main() {
  uint groups = (work_args[3] + items_per_group - 1u) / items_per_group;
  work_args[1] = min(groups, kMostGroups);
  work_args[2] = (groups + kMostGroups - 1u) / kMostGroups;
}
