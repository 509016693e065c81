// What the alpha of a view's picture says of a pixel. Shaders have the same in gl/view_alpha.glsl.
//
// Who asks whether something is filled asks for at least kFromFill; whether there is a model, for more than kNoModel:
// what has been scaled lies between two of them.
#pragma once

#include <cstdint>

namespace foresight::view_alpha {

inline constexpr std::uint8_t kFromImage = 255;  ///< the colour that a camera's image shows there
inline constexpr std::uint8_t kFromEdge = 254;   ///< likewise, but it may be that of another surface
inline constexpr std::uint8_t kFromFill = 128;   ///< a hole, filled from around it
inline constexpr std::uint8_t kBare = 64;        ///< the model, without any colour
inline constexpr std::uint8_t kNoModel = 0;

}  // namespace foresight::view_alpha
