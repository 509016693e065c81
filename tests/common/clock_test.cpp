#include "common/clock.hpp"

#include <gtest/gtest.h>

namespace foresight::clock_test {
namespace {

using namespace std::chrono_literals;

TEST(SteppedClock, RunsTasksInTheOrderOfTheirInstants) {
  SteppedClock clock;
  std::vector<std::pair<char, std::int64_t>> ran;
  clock.every(3ms, [&](RobotTime now) { ran.emplace_back('a', now.ns / 1'000'000); });
  clock.every(2ms, [&](RobotTime now) { ran.emplace_back('b', now.ns / 1'000'000); });
  clock.sleep_until({6'500'000});
  const std::vector<std::pair<char, std::int64_t>> expected{{'b', 2}, {'a', 3}, {'b', 4}, {'a', 6}, {'b', 6}};
  EXPECT_EQ(ran, expected) << "at one instant, in the order of registration";
  EXPECT_EQ(clock.now().ns, 6'500'000);
}

TEST(SteppedClock, StepsToTheNextTaskOrTheLimit) {
  SteppedClock clock;
  int runs = 0;
  clock.every(5ms, [&](RobotTime) { ++runs; });
  clock.step_towards({3'000'000});
  EXPECT_EQ(clock.now().ns, 3'000'000);
  clock.step_towards({100'000'000});
  EXPECT_EQ(clock.now().ns, 5'000'000);
  EXPECT_EQ(runs, 1);
  clock.step_towards({1});
  EXPECT_EQ(clock.now().ns, 5'000'000) << "never back";
}

TEST(MonotonicClock, SleepsUntilAnInstant) {
  MonotonicClock clock;
  const RobotTime due = clock.now() + 5ms;
  clock.sleep_until(due);
  EXPECT_GE(clock.now(), due);
}

}  // namespace
}  // namespace foresight::clock_test
