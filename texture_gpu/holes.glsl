// Notes tiles with texels on the surface that no camera has seen. Needs atlas.glsl.
// Per tile (4 * job + tile of its page): bit 0: there is such a texel, bit 1: it is not even filled, bit 2: another one was just
// seen for the first time.
layout(binding = 0, std430) buffer Holes { uint holes[]; };

void note_hole(int tile, uint raw, float before, float now) {
  bool core = raw >= 0x8000u;
  uint bits = now < kSeen ? (now > 0.0 ? 1u : 3u) : (before < kSeen ? 4u : 0u);
  if (core && bits != 0u) atomicOr(holes[tile], bits);
}
