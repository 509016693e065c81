#include "texture_gpu/slot_pool.hpp"

#include <gtest/gtest.h>

#include <set>

namespace foresight::slot_pool_test {
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

TEST(SlotPool, KnowsHowFarTheNextSlotsReachAndKeepsToALimit) {
  SlotPool pool(10);
  for (int i = 0; i < 4; ++i) pool.take();
  EXPECT_EQ(pool.reach(0), 4u);
  EXPECT_EQ(pool.reach(3), 7u);
  pool.give_back(1), pool.give_back(2);
  EXPECT_EQ(pool.reach(3), 5u) << "two of three come from those that came back";
  EXPECT_EQ(pool.reach(100), 10u);
  const std::uint32_t reach = pool.reach(3);
  for (int i = 0; i < 3; ++i) EXPECT_LT(pool.take(), reach);

  pool.limit(7);
  EXPECT_EQ(pool.free(), 2u);
  pool.limit(9);
  EXPECT_EQ(pool.capacity(), 7u) << "what is not there does not come back";
  pool.limit(0);
  EXPECT_EQ(pool.capacity(), 5u) << "slots that were taken stay";
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
}  // namespace foresight::slot_pool_test
