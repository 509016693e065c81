#include "common/time.hpp"

#include <gtest/gtest.h>

#include <type_traits>

namespace foresight::time_test {
namespace {

template <typename A, typename B>
concept Subtractable = requires(A a, B b) {
  a - b;
};
template <typename A, typename B>
concept Comparable = requires(A a, B b) {
  a < b;
};

TEST(Time, ClocksDoNotMix) {
  static_assert(Subtractable<RobotTime, RobotTime> && Comparable<RobotTime, RobotTime>);
  static_assert(!Subtractable<RobotTime, OperatorTime>);
  static_assert(!Comparable<RobotTime, OperatorTime>);
  static_assert(!std::is_convertible_v<OperatorTime, RobotTime>);
}

TEST(Time, AddsAndSubtractsToTheNanosecond) {
  const RobotTime t{1'700'000'000'123'456'789};
  EXPECT_EQ((t + Duration{1}).ns, 1'700'000'000'123'456'790);
  EXPECT_EQ((t - Duration{1}).ns, 1'700'000'000'123'456'788);
  EXPECT_EQ((t + Duration{1}) - t, Duration{1});
  EXPECT_LT(t, t + Duration{1});
}

TEST(Time, SecondsRoundToTheNearestNanosecond) {
  EXPECT_EQ(seconds(1e-9), Duration{1});
  EXPECT_EQ(seconds(0.6e-9), Duration{1});
  EXPECT_EQ(seconds(0.4e-9), Duration{0});
  EXPECT_EQ(seconds(-0.5), Duration{-500'000'000});
  EXPECT_DOUBLE_EQ(to_seconds(seconds(12.25)), 12.25);
}

}  // namespace
}  // namespace foresight::time_test
