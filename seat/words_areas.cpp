#include "seat/words_areas.hpp"

#include <algorithm>

namespace foresight {
namespace {

/// Of one direction of a picture: where the words' middle is in its part, and px that are left on both sides of it.
struct Extent {
  double middle = 0, room = 0;
};

Extent extent_of(double begin, double middle, double length) {
  return {begin + middle, std::min(begin + middle, length - begin - middle)};
}

}  // namespace

std::array<HudArea, 2> words_areas(const std::array<Lens, 2>& lenses, const std::array<ViewTarget, 2>& parts,
                                   double eyes_apart, double reach) {
  std::array<Extent, 2> across, down;
  double wide = reach, high = reach;  // tangents, of half of the area
  std::array<double, 2> focal{};
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const Lens::Parameters& p = lenses[eye].parameters();
    const ViewTarget& part = parts[eye];
    const ViewTarget view = fitted(part, p.width, p.height);
    const double scale = view.width / static_cast<double>(p.width);
    focal[eye] = p.fx * scale;
    const double aside = (eye == 0 ? 0.5 : -0.5) * eyes_apart / kWordsAway;  // a thing ahead is to the left eye's right
    const int top = part.y + part.height - view.y - view.height;
    across[eye] = extent_of(view.x - part.x, (p.cx + 0.5) * scale + focal[eye] * aside, part.width);
    down[eye] = extent_of(top, (p.cy + 0.5) * scale, part.height);
    wide = std::min(wide, across[eye].room / focal[eye]);
    high = std::min(high, down[eye].room / focal[eye]);
  }
  std::array<HudArea, 2> out;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const double half_width = std::max(0.0, wide * focal[eye]), half_height = std::max(0.0, high * focal[eye]);
    out[eye] = {across[eye].middle - half_width, down[eye].middle - half_height, 2 * half_width, 2 * half_height};
  }
  return out;
}

}  // namespace foresight
