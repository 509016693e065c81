#include "common/latest_value.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <thread>

namespace foresight::latest_value_test {
namespace {

using namespace std::chrono_literals;

TEST(LatestValue, GivesTheNewestOnceAndCountsTheRest) {
  LatestValue<std::unique_ptr<int>> slot;
  EXPECT_FALSE(slot.take());
  for (int i = 0; i < 5; ++i) slot.put(std::make_unique<int>(i));
  const auto taken = slot.take();
  ASSERT_TRUE(taken);
  EXPECT_EQ(**taken, 4);
  EXPECT_FALSE(slot.take()) << "once";
  EXPECT_EQ(slot.dropped(), 4u);
}

TEST(LatestValue, WaitsNoLongerThanTold) {
  LatestValue<int> slot;
  const auto before = std::chrono::steady_clock::now();
  EXPECT_FALSE(slot.take(20ms));
  EXPECT_GE(std::chrono::steady_clock::now() - before, 20ms);
}

TEST(LatestValue, UnderThreadsNothingIsTornOrTakenTwice) {
  struct Value {
    std::uint64_t a = 0, b = 0;
  };
  constexpr std::uint64_t kValues = 200'000;
  LatestValue<Value> slot;
  std::uint64_t taken = 0, last = 0;
  bool in_order = true, whole = true;
  {
    std::jthread reader([&] {
      while (last < kValues) {
        const auto value = slot.take(1s);
        if (!value) continue;
        ++taken;
        whole = whole && value->b == ~value->a;
        in_order = in_order && value->a > last;
        last = value->a;
      }
    });
    for (std::uint64_t i = 1; i <= kValues; ++i) slot.put({i, ~i});
  }
  EXPECT_TRUE(whole);
  EXPECT_TRUE(in_order);
  EXPECT_EQ(last, kValues) << "the newest always arrives";
  EXPECT_EQ(taken + slot.dropped(), kValues);
}

}  // namespace
}  // namespace foresight::latest_value_test
