// Reads what append_work() (work_list.glsl) stored: the item of this work group.
layout(binding = 15) uniform usamplerBuffer work;

bool next_work(out uint item) {
  uint index = gl_WorkGroupID.y + gl_WorkGroupID.z * 65535u;
  item = texelFetch(work, 8 + int(index)).r;
  return index < texelFetch(work, 3).r;
}
