// Where words stand before two eyes that look at pictures of their own, side by side.
//
//     left part           right part
//   |    .-----.  |    |  .-----.    |     the same rectangle in space, kWordsAway before the eyes' middle: what both
//   |    |words|  |    |  |words|    |     see there is one thing. At the same pixels of both parts, words would stand
//   at |    '-----'  |    |  '-----'    |     infinity, behind all that they cover, and be seen double.
#pragma once

#include <array>

#include "common/lens.hpp"
#include "display/view_target.hpp"
#include "seat/hud.hpp"

namespace foresight {

constexpr double kWordsAway = 1.0;  ///< m before the eyes

/// Of each part of a window, in which an eye's picture through its lens is fitted(). The eyes look the same way,
/// `eyes_apart` m from each other, the first is the left one (negative: the right one). `reach`: tangent of how far
/// from straight ahead words may be; infinite: as far as both parts go. Lenses' distortion is left aside.
std::array<HudArea, 2> words_areas(const std::array<Lens, 2>& lenses, const std::array<ViewTarget, 2>& parts,
                                   double eyes_apart, double reach);

}  // namespace foresight
