// Addresses in the atlas. Numbers as in texture_gpu/atlas_layout.hpp.
const uint kNoSlot = 0xffffffffu;

// First texel of a slot at a pyramid level (level 0: 16 texels a side).
ivec3 slot_origin(uint slot, int level) {
  return ivec3(int(slot & 7u) << (4 - level), int((slot >> 3) & 511u) << (4 - level), int(slot >> 12));
}

// Alpha of a texel: 0 without colour, 1 (of 255) filled, from 2 on seen. The codes from 2 on hold
// the resolution at which the texel was seen, log2(image px per texel) from -8 to 0 in 253 steps.
const float kFilled = 1.0 / 255.0;
const float kSeen = 1.5 / 255.0;  // threshold
float encode_quality(float px_per_texel) {
  return (2.0 + floor(clamp((log2(max(px_per_texel, 1e-6)) + 8.0) / 8.0, 0.0, 1.0) * 253.0 + 0.5)) / 255.0;
}
