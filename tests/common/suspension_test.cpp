#include "common/suspension.hpp"

#include <gtest/gtest.h>

namespace foresight::suspension_test {
namespace {

using namespace std::chrono_literals;

TEST(SuspensionWatch, TellsEachSuspensionOnce) {
  Duration asleep = 3h;
  SuspensionWatch watch([&] { return asleep; });
  EXPECT_FALSE(watch.woke()) << "what was before is nothing new";
  asleep += 1ms;
  EXPECT_FALSE(watch.woke()) << "two clocks are not read at the same instant";
  asleep += 2s;
  EXPECT_EQ(watch.woke(), Duration(2001ms));
  EXPECT_FALSE(watch.woke());
}

TEST(SuspensionWatch, TheMachineIsAwakeNow) {
  SuspensionWatch watch;
  EXPECT_FALSE(watch.woke());
  EXPECT_GE(SuspensionWatch::machine_asleep(), 0ns);
}

}  // namespace
}  // namespace foresight::suspension_test
