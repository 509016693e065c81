// Reads what append_work() (work_list.glsl) stored: the item of this work group, or, where INVOCATIONS_PER_ITEM is defined, as
// WorkList::finish() has it, of this invocation and its neighbours. WORDS_PER_ITEM: as in the WorkList. To be included after the
// size of groups.
#ifndef WORK_UNIT
#define WORK_UNIT 15
#endif
layout(binding = WORK_UNIT) uniform usamplerBuffer work;

#ifndef WORDS_PER_ITEM
#define WORDS_PER_ITEM 1
#endif

uint index_of_work() {
  uint group = gl_WorkGroupID.y + gl_WorkGroupID.z * 65535u;
#ifdef INVOCATIONS_PER_ITEM
  return (group * gl_WorkGroupSize.x * gl_WorkGroupSize.y + gl_LocalInvocationIndex) / INVOCATIONS_PER_ITEM;
#else
  return group;
#endif
}

uint word_of_work(int i) {
  return texelFetch(work, 4 + WORDS_PER_ITEM * int(index_of_work()) + i).r;
}

bool next_work(out uint item) {
  item = word_of_work(0);
  return index_of_work() < texelFetch(work, 3).r;
}

// Of the item's words after the first: numbers.
float number_of_work(int i) {
  return uintBitsToFloat(word_of_work(i));
}
