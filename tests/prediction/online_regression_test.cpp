#include "prediction/online_regression.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace foresight::online_regression_test {
namespace {

Weights numbers(std::initializer_list<double> values) {
  Weights w(static_cast<Eigen::Index>(values.size()));
  Eigen::Index i = 0;
  for (const double value : values) w[i++] = value;
  return w;
}

TEST(OnlineRegression, FindsTheWeightsAndLeavesWhatNothingWasSeenOfAtThePrior) {
  OnlineRegression regression(numbers({0, 0, 0.7}), numbers({1, 1, 1}), 1e9);
  std::mt19937 random(1);
  std::normal_distribution<double> any;
  for (int i = 0; i < 2000; ++i) {
    const double a = any(random), b = any(random);
    regression.forget(0.01);
    regression.add(numbers({a, b, 0}), 2 * a - 3 * b + 0.1 * any(random));
  }
  EXPECT_NEAR(regression.weights()[0], 2, 0.02);
  EXPECT_NEAR(regression.weights()[1], -3, 0.02);
  EXPECT_NEAR(regression.weights()[2], 0.7, 1e-12);
  EXPECT_NEAR(regression.spread(numbers({0, 0, 1})), 1, 1e-6);
  EXPECT_LT(regression.spread(numbers({1, 0, 0})), 1e-3);
}

TEST(OnlineRegression, ForgetsTowardsThePrior) {
  OnlineRegression regression(numbers({1}), numbers({1}), 10);
  for (int i = 0; i < 100; ++i) regression.add(numbers({1}), 5);
  EXPECT_NEAR(regression.weights()[0], 5, 0.05);
  regression.forget(200);
  EXPECT_NEAR(regression.weights()[0], 1, 1e-6);
}

TEST(OnlineRegression, WhatIsNotFiniteIsPassedOver) {
  OnlineRegression regression(numbers({1, 2}), numbers({1, 1}), 10);
  regression.add(numbers({1, std::numeric_limits<double>::quiet_NaN()}), 5);
  regression.add(numbers({1, 1}), std::numeric_limits<double>::infinity());
  EXPECT_EQ(regression.weights(), numbers({1, 2}));
}

}  // namespace
}  // namespace foresight::online_regression_test
