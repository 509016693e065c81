#include "common/statistics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace foresight::statistics_test {
namespace {

using Values = std::vector<double>;

TEST(Statistics, MedianIsTheMiddleInAnyOrder) {
  EXPECT_EQ(median(Values{3}), 3);
  EXPECT_EQ(median(Values{9, 1, 5}), 5);
  EXPECT_EQ(median(Values{9, 1, 4, 5}), 4.5);
  EXPECT_EQ(median(std::vector<float>{4, 1}), 2.5f);
  EXPECT_EQ(median(Values{2, 2, 2, 7, -1e300}), 2);
}

TEST(Statistics, OfNothingIsZero) {
  EXPECT_EQ(median(Values{}), 0);
  EXPECT_EQ(quantile(std::vector<float>{}, 0.9), 0);
  EXPECT_EQ(robust_sigma({}), 0);
  EXPECT_EQ(root_mean_square({}), 0);
}

TEST(Statistics, QuantilesLieBetweenTheirNeighbours) {
  const Values values{40, 10, 30, 20, 0};
  EXPECT_EQ(quantile(values, 0), 0);
  EXPECT_EQ(quantile(values, 1), 40);
  EXPECT_EQ(quantile(values, 0.25), 10);
  EXPECT_DOUBLE_EQ(quantile(values, 0.9), 36);
  EXPECT_EQ(quantile(values, 1.5), 40);  // no further than there is
}

TEST(Statistics, QuantilesAreThoseOfTheSortedValues) {
  std::mt19937 random(5);
  for (std::size_t size = 1; size < 60; ++size) {
    Values values(size);
    for (double& value : values) value = std::floor(std::uniform_real_distribution(-20.0, 20.0)(random));  // with ties
    Values sorted = values;
    std::sort(sorted.begin(), sorted.end());
    for (const double share : {0.05, 0.5, 0.8, 0.99}) {
      const double rank = share * static_cast<double>(size - 1);
      const auto below = static_cast<std::size_t>(rank);
      const double expected =
          std::lerp(sorted[below], sorted[std::min(below + 1, size - 1)], rank - static_cast<double>(below));
      EXPECT_NEAR(quantile(values, share), expected, 1e-12) << size << " values, " << share;
    }
  }
}

TEST(Statistics, RobustSigmaIsThatOfNormalValuesAndForgivesWrongOnes) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 3);
  Values values(20000);
  for (double& value : values) value = noise(random);
  EXPECT_NEAR(robust_sigma(values), 3, 0.1);
  for (std::size_t i = 0; i < 2000; ++i) values[i] = 1e9;
  EXPECT_NEAR(robust_sigma(values), 3, 0.6);
  EXPECT_GT(root_mean_square(values), 1e8);
}

TEST(Statistics, LengthsInThePlaneTellTheSigmaOfACoordinate) {
  std::mt19937 random(9);
  std::normal_distribution<double> noise(0, 0.4);
  Values lengths(20000);
  for (double& length : lengths) length = std::hypot(noise(random), noise(random));
  EXPECT_NEAR(robust_sigma_of_lengths(lengths), 0.4, 0.01);
}

TEST(Statistics, RootMeanSquare) {
  EXPECT_DOUBLE_EQ(root_mean_square(Values{3, -4}), std::sqrt(12.5));
}

}  // namespace
}  // namespace foresight::statistics_test
