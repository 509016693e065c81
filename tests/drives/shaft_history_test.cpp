#include "sim/drives/shaft_history.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace foresight::sim::shaft_history_test {
namespace {

using namespace std::chrono_literals;

RobotTime at(double ms) {
  return RobotTime{} + seconds(ms / 1000);
}

TEST(ShaftHistory, InterpolatesAndHoldsItsEnds) {
  ShaftHistory history(2, 100);
  for (const auto& [ms, a, b] : {std::tuple(10.0, 1.0, -1.0), {11.0, 2.0, -3.0}, {15.0, 6.0, -3.0}})
    history.add(at(ms), std::array{a, b});
  EXPECT_DOUBLE_EQ(history.at(0, at(10.25)), 1.25);
  EXPECT_DOUBLE_EQ(history.at(1, at(10.25)), -1.5);
  EXPECT_DOUBLE_EQ(history.at(0, at(11)), 2);
  EXPECT_DOUBLE_EQ(history.at(0, at(13)), 4) << "across a pause";
  EXPECT_DOUBLE_EQ(history.at(0, at(1)), 1);
  EXPECT_DOUBLE_EQ(history.at(1, at(100)), -3);
}

TEST(ShaftHistory, ForgetsTheOldestSteps) {
  ShaftHistory history(1, 8);
  for (int i = 0; i < 1000; ++i) {
    history.add(at(i), std::array{std::sin(0.01 * i)});
    for (int age = 0; age < std::min(i, 7); ++age)
      ASSERT_NEAR(history.at(0, at(i - age)), std::sin(0.01 * (i - age)), 1e-12);
    if (i > 8) {
      ASSERT_DOUBLE_EQ(history.at(0, at(i - 8)), std::sin(0.01 * (i - 7))) << "the oldest that is left";
    }
  }
}

}  // namespace
}  // namespace foresight::sim::shaft_history_test
