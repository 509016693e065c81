// The exposure control on scenes of one brightness, which steps up and down.
#include "sim/auto_exposure.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace foresight::sim::auto_exposure_test {
namespace {

/// A camera with a power law before a scene whose light is `light(image)`.
Meter camera(const std::function<double(int)>& light) {
  return [light](int image, double factor) { return std::min(1.0, std::pow(0.15 * light(image) * factor, 1 / 2.2)); };
}

TEST(AutoExposure, StartsAtRestAndStaysThere) {
  const AutoExposure control;
  const auto factors = run_auto_exposure(control, 50, camera([](int) { return 0.7; }));
  ASSERT_EQ(factors.size(), 50u);
  for (const double f : factors) EXPECT_EQ(f, factors[0]);
  EXPECT_NEAR(std::pow(0.15 * 0.7 * factors[0], 1 / 2.2), control.target, 0.01);
}

TEST(AutoExposure, FollowsALampLateAndInSteps) {
  const AutoExposure control;
  const auto meter = camera([](int image) { return image < 30 ? 1.0 : 0.4; });
  const auto factors = run_auto_exposure(control, 120, meter);
  for (int i = 1; i <= 30 + control.latency; ++i) EXPECT_EQ(factors[static_cast<std::size_t>(i)], factors[0]) << i;
  int steps = 0;
  for (std::size_t i = 1; i < factors.size(); ++i) {
    const double step = std::log2(factors[i] / factors[i - 1]);
    EXPECT_GE(step, 0) << "it does not swing back, image " << i;
    EXPECT_LE(step, control.largest_step + 1e-9);
    steps += step > 0;
  }
  EXPECT_GE(steps, 3);
  const double stops_off = 2.2 * std::log2(meter(119, factors.back()) / control.target);
  EXPECT_LE(std::abs(stops_off), control.tolerance);
}

TEST(AutoExposure, StaysWithinItsRange) {
  const AutoExposure control;
  const auto factors = run_auto_exposure(control, 200, camera([](int image) { return image < 100 ? 1e-4 : 1e4; }));
  EXPECT_DOUBLE_EQ(factors[90], std::exp2(control.most_stops));
  EXPECT_DOUBLE_EQ(factors[199], std::exp2(-control.most_stops));
}

}  // namespace
}  // namespace foresight::sim::auto_exposure_test
