#include "common/triple_buffer.hpp"

#include <gtest/gtest.h>

#include <array>
#include <thread>

namespace foresight::triple_buffer_test {
namespace {

TEST(TripleBuffer, GivesTheNewestOnce) {
  TripleBuffer<int> buffer;
  EXPECT_FALSE(buffer.take());
  buffer.put(1);
  buffer.put(2);
  EXPECT_EQ(buffer.take(), 2);
  EXPECT_FALSE(buffer.take());
  buffer.put(3);
  EXPECT_EQ(buffer.take(), 3);
}

TEST(TripleBuffer, NeverTearsOrGoesBackBetweenThreads) {
  using Value = std::array<std::uint64_t, 32>;
  TripleBuffer<Value> buffer;
  constexpr std::uint64_t kLast = 200'000;
  std::jthread writer([&] {
    Value value{};
    for (std::uint64_t i = 1; i <= kLast; ++i) {
      value.fill(i);
      buffer.put(value);
    }
  });
  std::uint64_t newest = 0;
  while (newest < kLast) {
    const auto value = buffer.take();
    if (!value) continue;
    ASSERT_GT((*value)[0], newest);
    for (std::uint64_t part : *value) ASSERT_EQ(part, (*value)[0]);
    newest = (*value)[0];
  }
}

}  // namespace
}  // namespace foresight::triple_buffer_test
