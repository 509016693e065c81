#include "prediction/line_gaps.hpp"

#include <gtest/gtest.h>

namespace foresight::line_gaps_test {
namespace {

// Reports each 10 ms, and a gap of these seconds each second, until `until`.
void pass(LineGaps& gaps, double& now, double until, double gap) {
  while (now < until) {
    for (int i = 0; i < 80; ++i) gaps.add(0.01, now += 0.01);
    gaps.add(gap, now += gap);
  }
}

TEST(LineGaps, NothingIsKnownBeforeTheFirst) {
  LineGaps gaps(1);
  EXPECT_EQ(gaps.chance_to_reach(0.3, 0.1), 0.5);
  gaps.add(0.01, 1);
  EXPECT_EQ(gaps.chance_to_reach(0.3, 0.1), 0.5) << "what was not late says nothing of what is";
}

TEST(LineGaps, GapsThatEndInTimeAreTrustedToDoSoAgain) {
  LineGaps gaps(1);
  double now = 0;
  pass(gaps, now, 20, 0.2);
  EXPECT_LT(gaps.chance_to_reach(0.3, 0.15), 0.03);
  EXPECT_EQ(gaps.chance_to_reach(0.3, 0.25), 0.5) << "none has lasted as long";
  EXPECT_GT(gaps.chance_to_reach(0.18, 0.15), 0.9);
}

TEST(LineGaps, LongOnesAreNotForgottenForAMinute) {
  LineGaps gaps(1);
  double now = 0;
  pass(gaps, now, 5, 0.6);
  pass(gaps, now, 40, 0.2);
  EXPECT_NEAR(gaps.chance_to_reach(0.3, 0.15), 0.1, 0.03);
  pass(gaps, now, 70, 0.2);
  EXPECT_LT(gaps.chance_to_reach(0.3, 0.15), 0.02);
}

TEST(LineGaps, AreExpectedToLastAsLongAsOthersThatLastedSoLong) {
  LineGaps gaps(1);
  EXPECT_EQ(gaps.expected_length(0.1), 0.2) << "as long again";
  double now = 0;
  pass(gaps, now, 20, 0.2);
  pass(gaps, now, 40, 0.7);
  EXPECT_GE(gaps.expected_length(0.06), 0.2);
  EXPECT_EQ(gaps.expected_length(0.25), 0.7);
  EXPECT_EQ(gaps.expected_length(0.8), 1.6) << "none has lasted as long";
}

TEST(LineGaps, UsualIsWhatMostKeep) {
  LineGaps gaps(1);
  double now = 0;
  pass(gaps, now, 30, 0.2);
  EXPECT_LT(gaps.usual(), 0.03);
  for (int i = 0; i < 500; ++i) gaps.add(0.15, now += 0.15);
  EXPECT_NEAR(gaps.usual(), 0.15, 0.03);
  for (int i = 0; i < 50; ++i) gaps.add(100, now += 100);
  EXPECT_LE(gaps.usual(), 1);
}

}  // namespace
}  // namespace foresight::line_gaps_test
