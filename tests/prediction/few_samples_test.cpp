#include "prediction/few_samples.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "prediction/calibrated_sigma.hpp"

namespace foresight::few_samples_test {
namespace {

// Quantiles of 97.5 % from tables of Student's distribution.
TEST(FewSamples, WidenAsStudentSays) {
  EXPECT_NEAR(1.96 * widening_of_few(3), 3.182, 0.05);
  EXPECT_NEAR(1.96 * widening_of_few(5), 2.571, 0.01);
  EXPECT_NEAR(1.96 * widening_of_few(10), 2.228, 0.002);
  EXPECT_NEAR(1.96 * widening_of_few(60), 2.000, 0.001);
  EXPECT_EQ(widening_of_few(0), widening_of_few(2));
}

// An error that keeps 0.9 of itself tells as much as 1 / 19 of independent ones.
TEST(FewSamples, ErrorsThatAreAlikeCountAsFewer) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  AlikeErrors alike, independent;
  double off = 0;
  for (int i = 0; i < 20000; ++i) {
    off = 0.9 * off + normal(random);
    alike.add(off);
    independent.add(normal(random));
  }
  EXPECT_NEAR(alike.independent() / 20000, 0.1 / 1.9, 0.01);
  EXPECT_NEAR(independent.independent() / 20000, 1, 0.03);
  EXPECT_NEAR(std::sqrt(independent.squares() / static_cast<double>(independent.count())), 1, 0.02);
}

// Share within 2 sigma in the seconds 10 to 15 after a sigma that was told three times too wide.
double inside_after_wide(double assumed) {
  constexpr double kStep = 0.02;
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::size_t inside = 0, count = 0;
  for (int run = 0; run < 40; ++run) {
    CalibratedSigma sigma(3, 1e-6, 5, CalibratedSigma::kScaleOfOne, assumed);
    for (double t = 0; t < 15; t += kStep) {
      const double error = std::abs(normal(random)), told = sigma.sigma();
      if (t >= 10) ++count, inside += error <= 2 * told ? 1 : 0;
      sigma.score(error, told, kStep);
    }
  }
  return static_cast<double>(inside) / static_cast<double>(count);
}

TEST(FewSamples, WhatWasToldTooWideDoesNotBecomeTooNarrow) {
  EXPECT_NEAR(inside_after_wide(1), 0.95, 0.01);
  EXPECT_LT(inside_after_wide(0), inside_after_wide(1) - 0.01);
}

}  // namespace
}  // namespace foresight::few_samples_test
