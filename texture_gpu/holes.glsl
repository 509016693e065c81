// Notes pages with texels on the surface that no camera has seen. Needs atlas.glsl.
layout(binding = 0, std430) buffer Holes { uint holes[]; };  // per job: bit 0: such a texel, bit 1: and not even filled

void note_hole(int job, uint raw, float alpha) {
  bool core = raw >= 0x8000u;
  if (core && alpha < kSeen) atomicOr(holes[job], alpha > 0.0 ? 1u : 3u);
}
