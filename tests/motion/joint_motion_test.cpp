#include "motion/joint_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace foresight::joint_motion_test {
namespace {

constexpr double kDt = 0.004;
constexpr JointLimits kLimits{-2, 2, 1.5, 4, 40};

/// Position, velocity, acceleration and jerk as an observer of the set-points would compute them.
void expect_within(const JointMotion& before, const JointMotion& next, const JointLimits& limits, const char* what) {
  constexpr double kRounding = 1e-9;
  ASSERT_LE(next.position, limits.max_position + kRounding) << what;
  ASSERT_GE(next.position, limits.min_position - kRounding) << what;
  ASSERT_LE(std::abs(next.velocity), limits.velocity * (1 + kRounding)) << what;
  ASSERT_LE(std::abs(next.acceleration), limits.acceleration * (1 + kRounding)) << what;
  ASSERT_LE(std::abs(next.acceleration - before.acceleration), limits.jerk * kDt * (1 + 1e-6)) << what;
  ASSERT_NEAR(next.position - before.position, 0.5 * kDt * (before.velocity + next.velocity),
              limits.jerk * kDt * kDt * kDt)
      << what << ": the velocity is that of the positions";
}

TEST(JointMotion, BrakeEndsAtRestWithinTheLimitsFromAnywhere) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    JointMotion m{0, kLimits.velocity * unit(random), kLimits.acceleration * unit(random)};
    // A state from which the velocity limit can be kept.
    if (std::abs(m.velocity + m.acceleration * std::abs(m.acceleration) / kLimits.jerk) > kLimits.velocity) continue;
    int cycles = 0;
    for (; m.velocity != 0 || m.acceleration != 0; ++cycles) {
      const JointMotion next = brake(m, kLimits, kDt);
      expect_within(m, next, {-10, 10, kLimits.velocity, kLimits.acceleration, kLimits.jerk}, "brake");
      m = next;
      ASSERT_LT(cycles, 400);
    }
  }
}

TEST(JointMotion, BrakesNoHarderThanItsAccelerationHoweverLargeTheJerk) {
  for (const double jerk : {40.0, 4e3, 4e4, 1e6, 1e12, 1e160, 1e308}) {
    JointLimits limits = kLimits;
    limits.jerk = jerk;
    const JointMotion start{0, 1.5, 0};
    for (JointMotion m = start; m.velocity != 0;) {
      const JointMotion next = brake(m, limits, kDt);
      ASSERT_LE(m.velocity - next.velocity, limits.acceleration * kDt * (1 + 1e-9)) << jerk;
      m = next;
    }
    EXPECT_GE(stop_position(start, limits, kDt), 0.95 * 1.5 * 1.5 / (2 * limits.acceleration)) << jerk;
  }
}

TEST(JointMotion, ReachesTheTargetWithoutOvershoot) {
  for (double target : {0.001, 0.05, 1.0, -1.9}) {
    JointMotion m;
    double farthest = 0;
    for (int i = 0; i < 2000; ++i) {
      const StoppableMotion next = approach(m, target, kLimits, 1, kDt);
      expect_within(m, next.motion, kLimits, "approach");
      EXPECT_EQ(next.stop, stop_position(next.motion, kLimits, kDt));
      m = next.motion;
      farthest = std::max(farthest, m.position * (target < 0 ? -1 : 1));
    }
    EXPECT_NEAR(m.position, target, 1e-6);
    EXPECT_LT(farthest, std::abs(target) * 1.02 + 1e-4) << target;
  }
}

TEST(JointMotion, KeepsItsLimitsWhateverIsAskedFor) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(-1, 1);
  JointMotion m;
  double fastest = 0, farthest = 0, target = 0;
  for (int i = 0; i < 200'000; ++i) {
    if (i % 50 == 0 || i % 777 < 20) target = 100 * unit(random);
    const JointMotion next = approach(m, target, kLimits, 1, kDt).motion;
    expect_within(m, next, kLimits, "random targets");
    m = next;
    fastest = std::max(fastest, std::abs(m.velocity));
    farthest = std::max(farthest, std::abs(m.position));
  }
  EXPECT_GT(fastest, 0.9 * kLimits.velocity) << "the limits are used";
  EXPECT_GT(farthest, 0.99 * kLimits.max_position);
}

TEST(JointMotion, SpeedScalesTheVelocity) {
  JointMotion m;
  double fastest = 0;
  for (int i = 0; i < 1000; ++i) {
    m = approach(m, 1.9, kLimits, 0.1, kDt).motion;
    fastest = std::max(fastest, m.velocity);
  }
  EXPECT_NEAR(fastest, 0.15, 0.01);
}

}  // namespace
}  // namespace foresight::joint_motion_test
