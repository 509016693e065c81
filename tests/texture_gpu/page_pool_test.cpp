#include "texture_gpu/page_pool.hpp"

#include <gtest/gtest.h>

#include <set>

namespace foresight::page_pool_test {
namespace {

TEST(SlotPool, HandsOutEachSlotOnceLowestFirst) {
  SlotPool pool(5);
  for (std::uint32_t i = 0; i < 5; ++i) EXPECT_EQ(pool.take(), i);
  EXPECT_EQ(pool.take(), atlas::kNoSlot);
  EXPECT_EQ(pool.used(), 5u);
  EXPECT_EQ(pool.free(), 0u);
}

TEST(SlotPool, CountsWhatComesBackAndHandsItOutAgain) {
  SlotPool pool(8);
  std::set<std::uint32_t> held;
  for (int i = 0; i < 6; ++i) held.insert(pool.take());
  for (std::uint32_t slot : {1u, 4u}) pool.give_back(slot), held.erase(slot);
  EXPECT_EQ(pool.used(), 4u);
  EXPECT_EQ(pool.free(), 4u);
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(held.insert(pool.take()).second) << "a slot was handed out twice";
  EXPECT_EQ(pool.take(), atlas::kNoSlot);
}

TEST(AtlasLayout, APageIsCountedWithItsPyramid) {
  std::uint64_t texels = 0;
  for (int level = 0, side = atlas::kPage; level < atlas::kLevels; ++level, side /= 2)
    texels += static_cast<std::uint64_t>(side * side);
  EXPECT_EQ(atlas::kColourBytes, atlas::kTexelBytes * texels);
  EXPECT_EQ(atlas::kHeightBytes, 2u * atlas::kPage * atlas::kPage);
}

}  // namespace
}  // namespace foresight::page_pool_test
