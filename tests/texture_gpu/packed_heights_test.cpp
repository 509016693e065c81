// Heights come back as they were, and take little room where a surface is made of planes.
#include "texture_gpu/packed_heights.hpp"

#include <gtest/gtest.h>

#include <random>

#include "texture_gpu/chart_raster.hpp"

namespace foresight::packed_heights_test {
namespace {

TEST(PackedHeights, ComeBackAsTheyWere) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> any(0, 0xffff);
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 300}, {300, 1}, {17, 33}, {256, 256}}) {
    std::vector<std::uint16_t> raw(static_cast<std::size_t>(width * height));
    for (auto& value : raw) value = static_cast<std::uint16_t>(any(random));
    EXPECT_EQ(PackedHeights(raw, width).unpacked(), raw) << width << " x " << height;
  }
  EXPECT_TRUE(PackedHeights().unpacked().empty());
  EXPECT_TRUE(PackedHeights({}, 16).unpacked().empty());
}

TEST(PackedHeights, OfPlanesTakeLittle) {
  constexpr int kSide = 200;
  std::vector<std::uint16_t> raw;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)  // two planes that meet along a diagonal, rounded; a rim without surface
      raw.push_back(x < 2 || y < 2
                        ? std::uint16_t{0}
                        : static_cast<std::uint16_t>(ChartRaster::kCore | std::lround(9000 + 31.3 * std::max(x, y))));
  const PackedHeights packed(raw, kSide);
  EXPECT_EQ(packed.unpacked(), raw);
  EXPECT_LT(packed.bytes(), 2 * raw.size() / 4);
}

}  // namespace
}  // namespace foresight::packed_heights_test
