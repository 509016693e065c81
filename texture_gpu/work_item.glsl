// Reads what append_work() (work_list.glsl) stored: the item of this work group, or, where ITEMS_PER_GROUP is more than 1, as
// in the WorkList, of this invocation and its neighbours: INVOCATIONS_PER_ITEM of them, 1 unless defined. WORDS_PER_ITEM: as in
// the WorkList.
#ifndef WORK_UNIT
#define WORK_UNIT 15
#endif
layout(binding = WORK_UNIT) uniform usamplerBuffer work;

#ifndef ITEMS_PER_GROUP
#define ITEMS_PER_GROUP 1
#endif
#ifndef INVOCATIONS_PER_ITEM
#define INVOCATIONS_PER_ITEM 1
#endif
#ifndef WORDS_PER_ITEM
#define WORDS_PER_ITEM 1
#endif

uint index_of_work() {
  uint index = (gl_WorkGroupID.y + gl_WorkGroupID.z * 65535u) * ITEMS_PER_GROUP;
#if ITEMS_PER_GROUP > 1
  index += gl_LocalInvocationIndex / INVOCATIONS_PER_ITEM;
#endif
  return index;
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
