// Words before two eyes are one thing at one place.
#include "seat/words_areas.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/small_scene.hpp"

namespace foresight::words_areas_test {
namespace {

constexpr double kApart = 0.063;
constexpr std::array kParts{ViewTarget{.x = 4, .y = 4, .width = 640, .height = 800},
                            ViewTarget{.x = 644, .y = 4, .width = 640, .height = 800}};

/// A lens whose middle is off to a side, as those of panels are.
Lens panel(double off) {
  Lens::Parameters p = small_lens("pinhole").parameters();
  p.cx += off;
  return Lens(p);
}

/// Where a place of a part, px from its top left, is seen: at the words' distance from the eyes' middle.
Eigen::Vector2d seen(const Lens& lens, const ViewTarget& part, double aside, double x, double y) {
  const Lens::Parameters& p = lens.parameters();
  const ViewTarget view = fitted(part, p.width, p.height);
  const double scale = view.width / static_cast<double>(p.width);
  const double left = view.x - part.x, top = part.height - (view.y - part.y) - view.height;
  return {aside + kWordsAway * ((x - left) / scale - 0.5 - p.cx) / p.fx,
          kWordsAway * ((y - top) / scale - 0.5 - p.cy) / p.fy};
}

void expect_one_thing(const std::array<Lens, 2>& lenses, double apart, double reach) {
  const auto areas = words_areas(lenses, kParts, apart, reach);
  std::array<Eigen::Vector2d, 2> from, to;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const auto& [left, top, width, height] = areas[eye];
    const double aside = (eye == 0 ? -0.5 : 0.5) * apart;
    EXPECT_GE(left, -1e-9);
    EXPECT_GE(top, -1e-9);
    EXPECT_LE(left + width, kParts[eye].width + 1e-9);
    EXPECT_LE(top + height, kParts[eye].height + 1e-9);
    from[eye] = seen(lenses[eye], kParts[eye], aside, left, top);
    to[eye] = seen(lenses[eye], kParts[eye], aside, left + width, top + height);
  }
  EXPECT_LT((from[0] - from[1]).norm(), 0.002) << "m";
  EXPECT_LT((to[0] - to[1]).norm(), 0.002);
  EXPECT_GT((to[0] - from[0]).x(), 0.4);
  EXPECT_LE((to[0] - from[0]).x(), 2 * reach * kWordsAway + 1e-6);
}

TEST(WordsAreas, BothEyesSeeThemAtOnePlace) {
  constexpr double kAnywhere = std::numeric_limits<double>::infinity();
  expect_one_thing({panel(0), panel(0)}, kApart, kAnywhere);
  expect_one_thing({panel(0), panel(0)}, -kApart, kAnywhere);
  expect_one_thing({panel(14), panel(-14)}, kApart, kAnywhere);
  expect_one_thing({panel(-14), panel(9)}, kApart, 0.5);
}

TEST(WordsAreas, TheLeftEyeSeesThemFartherRight) {
  const auto areas = words_areas({panel(0), panel(0)}, kParts, kApart, 0.4);
  const double shift = areas[0].left - areas[1].left;
  const double focal = panel(0).parameters().fx * 640 / panel(0).width();
  EXPECT_NEAR(shift, focal * kApart / kWordsAway, 0.5);
}

TEST(WordsAreas, BearTheSmallestWindow) {
  const std::array<ViewTarget, 2> tiny{ViewTarget{.width = 1, .height = 1},
                                       ViewTarget{.x = 1, .width = 1, .height = 1}};
  for (const HudArea& area : words_areas({panel(0), panel(0)}, tiny, kApart, 0.5)) {
    EXPECT_GE(area.width, 0);
    EXPECT_GE(area.height, 0);
  }
}

}  // namespace
}  // namespace foresight::words_areas_test
