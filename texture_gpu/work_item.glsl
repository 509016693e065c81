// Reads what append_work() (work_list.glsl) stored: the item of this work group, or of this
// invocation where ITEMS_PER_GROUP is the group's size, as in the WorkList.
#ifndef WORK_UNIT
#define WORK_UNIT 15
#endif
layout(binding = WORK_UNIT) uniform usamplerBuffer work;

#ifndef ITEMS_PER_GROUP
#define ITEMS_PER_GROUP 1
#endif

bool next_work(out uint item) {
  uint index = (gl_WorkGroupID.y + gl_WorkGroupID.z * 65535u) * ITEMS_PER_GROUP;
#if ITEMS_PER_GROUP > 1
  index += gl_LocalInvocationIndex;
#endif
  item = texelFetch(work, 4 + int(index)).r;
  return index < texelFetch(work, 3).r;
}
