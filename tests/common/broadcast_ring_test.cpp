#include "common/broadcast_ring.hpp"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace foresight::broadcast_ring_test {
namespace {

/// All of one put, or torn.
struct Block {
  std::array<std::uint32_t, 33> words{};
  static Block of(std::uint32_t n) {
    Block out;
    out.words.fill(n);
    return out;
  }
  bool whole() const {
    for (const std::uint32_t word : words)
      if (word != words[0]) return false;
    return true;
  }
};

TEST(BroadcastRing, EveryReaderGetsEveryValue) {
  BroadcastRing<int> ring(4);
  auto one = ring.reader(), other = ring.reader();
  EXPECT_FALSE(one.take());
  for (int i = 0; i < 10; ++i) {
    ring.put(i);
    EXPECT_EQ(one.take(), i);
    EXPECT_FALSE(one.take());
    for (int k = i - 2; i % 3 == 2 && k <= i; ++k) EXPECT_EQ(other.take(), k);
  }
  EXPECT_EQ(one.dropped() + other.dropped(), 0u);
}

TEST(BroadcastRing, ASlowReaderMissesTheOldestAndIsTold) {
  BroadcastRing<int> ring(4);
  auto slow = ring.reader();
  for (int i = 0; i < 11; ++i) ring.put(i);
  auto late = ring.reader();
  for (int i = 7; i < 11; ++i) EXPECT_EQ(slow.take(), i);
  EXPECT_FALSE(slow.take());
  EXPECT_EQ(slow.dropped(), 7u);
  EXPECT_FALSE(late.take()) << "only what comes from now on";
  ring.put(11);
  EXPECT_EQ(late.take(), 11);
  EXPECT_EQ(late.dropped(), 0u);
}

// A small ring, so that the writer overtakes its readers all the time.
TEST(BroadcastRing, ThreadsSeeWholeValuesInOrderAndCountAllOthers) {
  constexpr std::uint32_t kValues = 20'000;
  BroadcastRing<Block> ring(8);
  std::vector<std::jthread> threads;
  for (int k = 0; k < 3; ++k)
    threads.emplace_back([&ring, reader = ring.reader(), k]() mutable {
      std::uint64_t taken = 0;
      for (std::uint32_t last = 0; last < kValues;) {
        const auto block = reader.take();
        if (!block) {
          std::this_thread::yield();
          continue;
        }
        ASSERT_TRUE(block->whole()) << "reader " << k;
        ASSERT_GT(block->words[0], last) << "reader " << k;
        last = block->words[0];
        ++taken;
        ASSERT_EQ(taken + reader.dropped(), last) << "reader " << k;
      }
    });
  for (std::uint32_t i = 1; i <= kValues; ++i) {
    ring.put(Block::of(i));
    if (i % 64 == 0) std::this_thread::yield();
  }
}

}  // namespace
}  // namespace foresight::broadcast_ring_test
