// Addresses in the atlas. Numbers as in texture_gpu/atlas_layout.hpp.
const uint kNoSlot = 0xffffffffu;

// First texel of a slot at a pyramid level (level 0: 16 texels a side).
ivec3 slot_origin(uint slot, int level) {
  return ivec3(int(slot & 7u) << (4 - level), int((slot >> 3) & 255u) << (4 - level), int(slot >> 11));
}

// A texel is 32 bits (texel.hpp): three mantissas of 8 bits with one power of two, up to kBrightest, and a code of 5 bits. Unpacked,
// alpha is the code's share of 31: 0 without colour, 1 filled, from 2 on seen. These hold the resolution at which the texel
// was seen, log2(image px per texel) from -8 to 0 in 29 steps; above level 0, the share of seen texels.
const float kStep = 1.0 / 31.0;
const float kFilled = kStep;
const float kLeastSeen = 2.0 * kStep;
const float kSeen = 1.5 * kStep, kColoured = 0.5 * kStep;  // thresholds
const float kBrightest = 15.9375;
const float kStepsPerDoubling = 29.0 / 8.0;

vec4 unpack_texel(vec4 bytes) {
  int last = int(255.0 * bytes.a + 0.5);
  float unit = intBitsToFloat((116 + (last & 7)) << 23);  // 2^(exponent - 11)
  return vec4(255.0 * unit * bytes.rgb, kStep * float(last >> 3));
}

// As imageStore() takes it.
uvec4 pack_texel(vec4 texel) {
  vec3 colour = clamp(texel.rgb, 0.0, kBrightest);
  // 256 / 255.4: so that no mantissa rounds to 256.
  float largest = max(max(colour.r, colour.g), colour.b) * (256.0 / 255.4);
  int exponent = clamp((floatBitsToInt(largest) >> 23) - 123, 0, 7);
  // Signed numbers: CPUs convert floats to unsigned ones far more slowly.
  ivec3 mantissas = ivec3(intBitsToFloat((138 - exponent) << 23) * colour + 0.5);
  int code = int(31.0 * texel.a + 0.5);
  return uvec4(mantissas.r | mantissas.g << 8 | mantissas.b << 16 | exponent << 24 | code << 27);
}

float decode_quality(float alpha) {  // px per texel
  return exp2((alpha - kLeastSeen) / (kStep * kStepsPerDoubling) - 8.0);
}

float encode_quality(float px_per_texel) {
  return kLeastSeen + kStep * floor(clamp(log2(max(px_per_texel, 1e-6)) + 8.0, 0.0, 8.0) * kStepsPerDoubling + 0.5);
}
