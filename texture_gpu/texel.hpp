// A colour of the atlas in 32 bits, as atlas.glsl packs it.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace foresight::atlas {

/// From the lowest bits on: mantissas of red, green and blue, 8 bits each, the exponent that they share, 3 bits, the
/// code, 5. Values of 1 are white at the reference exposure.
struct Texel {
  std::uint32_t bits = 0;

  /// 0: no colour, 1: filled, from 2 on seen (atlas.glsl).
  int code() const { return static_cast<int>(bits >> 27); }

  /// Red, green, blue: 0 up to 16, in steps of 2^-11 at least and 1/128 of the largest of them at most.
  Eigen::Array3f colour() const {
    const auto exponent = static_cast<int>(bits >> 24 & 7);
    const auto mantissa = [&](int shift) { return static_cast<float>(bits >> shift & 255); };
    return Eigen::Array3f(mantissa(0), mantissa(8), mantissa(16)) * static_cast<float>(1 << exponent) / 2048;
  }
};
static_assert(sizeof(Texel) == 4);

}  // namespace foresight::atlas
