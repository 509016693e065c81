#include "sim/drives/motor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sim/drives/reference.hpp"

namespace foresight::sim::motor_test {
namespace {

constexpr double kDt = 1e-3;

void run(Motor& motor, double time_s) {
  for (int i = 0; i < std::lround(time_s / kDt); ++i) motor.step(kDt);
}

TEST(Motor, TheBrakeHoldsAWeightOnlyAfterItsDelay) {
  MotorConfig config;
  config.load = 5;
  Motor motor(config);
  run(motor, 1);
  EXPECT_EQ(motor.shaft().position, 0) << "closed from the start";
  motor.power(true);
  run(motor, 1);
  EXPECT_NEAR(motor.shaft().position, 0, 1e-3) << "the servo holds it";
  motor.power(false);
  run(motor, 0.025);
  EXPECT_GT(motor.shaft().velocity, 0.05) << "nothing holds it until the brake grips";
  run(motor, 0.1);
  const double sagged = motor.shaft().position;
  EXPECT_EQ(motor.shaft().velocity, 0);
  EXPECT_TRUE(motor.shaft().brake_closed);
  run(motor, 1);
  EXPECT_EQ(motor.shaft().position, sagged);
}

TEST(Motor, LimitsVelocityAccelerationAndTorqueOfAStep) {
  MotorConfig config;
  config.following_error_limit = 10;
  Motor motor(config);
  motor.power(true);
  motor.track({1, 0, 0});
  run(motor, 3);
  EXPECT_NEAR(motor.shaft().position, 1, 1e-3);
  EXPECT_LE(motor.shaft().largest_velocity, config.max_velocity + 1e-9);
  EXPECT_LE(motor.shaft().largest_acceleration, config.max_acceleration + config.coulomb + 1e-9);
  EXPECT_GT(motor.shaft().largest_velocity, 1.0);
  EXPECT_LT(motor.shaft().most_positive, 1.03) << "no overshoot to speak of";
}

TEST(Motor, WithLimitsOffItDoesWhatItIsTold) {
  MotorConfig config;
  config.limits_off = true;
  config.max_stop = 0.5;
  Motor motor(config);
  motor.power(true);
  for (int i = 1; i <= 500; ++i) {
    const double t = i * kDt;
    motor.track({10 * t * t, 20 * t, 20});
    motor.step(kDt);
  }
  EXPECT_NEAR(motor.shaft().largest_velocity, 10, 0.1);
  EXPECT_NEAR(motor.shaft().largest_acceleration, 20, 2);
  EXPECT_GT(motor.shaft().most_positive, 2.4);
}

TEST(Motor, AStopStopsAndALagIsNoticed) {
  MotorConfig config;
  config.max_stop = 0.2;
  Motor motor(config);
  motor.power(true);
  motor.track({0.5, 0, 0});
  run(motor, 2);
  EXPECT_EQ(motor.shaft().position, 0.2);
  EXPECT_TRUE(motor.shaft().hit_stop);
  EXPECT_TRUE(motor.following_failed());
  motor.power(false);
  EXPECT_FALSE(motor.following_failed());
}

TEST(Motor, ComesToExactRest) {
  Motor motor({});
  motor.power(true);
  motor.track({0.01, 0, 0});
  run(motor, 2);
  EXPECT_EQ(motor.shaft().velocity, 0);
  EXPECT_NEAR(motor.shaft().position, 0.01, 1e-4);
}

TEST(Approach, EndsExactlyAndKeepsItsLimits) {
  for (const double target : {1.0, -0.3, 0.001, 1e-6, -7.0}) {
    Reference at;
    const ProfileLimits limits{0.8, 2, 4};
    double fastest = 0, up = 0, down = 0;
    int steps = 0;
    for (; steps < 20'000 && (at.position != target || at.velocity != 0); ++steps) {
      const Reference next = approach(at, target, limits, kDt);
      fastest = std::max(fastest, std::abs(next.velocity));
      const double speed_up = (std::abs(next.velocity) - std::abs(at.velocity)) / kDt;
      up = std::max(up, speed_up);
      down = std::max(down, -speed_up);
      at = next;
    }
    EXPECT_EQ(at.position, target);
    EXPECT_LE(fastest, 0.8 + 1e-12);
    EXPECT_LE(up, 2 * (1 + 1e-9)) << target;
    EXPECT_LE(down, 4 * 2.01) << target << ": the last step may take two steps' worth";
    const double d = std::abs(target), ramps = 0.64 / 4 + 0.64 / 8;
    const double ideal = d > ramps ? 0.8 / 2 + 0.8 / 4 + (d - ramps) / 0.8 : std::sqrt(2 * d * (1.0 / 2 + 1.0 / 4));
    EXPECT_NEAR(steps * kDt, ideal, 0.01 + 0.01 * ideal) << target;
  }
}

// Set-points of x = a t^2 / 2 at 100 Hz: the spline's acceleration is a, from the second interval on.
TEST(CyclicInterpolator, AddsNoAccelerationOfItsOwn) {
  CyclicInterpolator spline;
  spline.start(0);
  double position = 0, largest_jump = 0;
  for (int k = 1; k <= 50; ++k) {
    const double t = k * 0.01;
    spline.push(3 * t * t / 2, 0.01);
    for (int i = 0; i < 10; ++i) {
      const Reference at = spline.step(kDt);
      if (k > 2) {
        EXPECT_NEAR(at.acceleration, 3, 1e-9);
      }
      largest_jump = std::max(largest_jump, std::abs(at.position - position - at.velocity * kDt));
      position = at.position;
    }
  }
  EXPECT_LT(largest_jump, 3 * kDt * kDt) << "position is the integral of velocity";
  for (int k = 0; k < 3; ++k) {
    spline.push(spline.last(), 0.01);
    for (int i = 0; i < 10; ++i) position = spline.step(kDt).position;
  }
  EXPECT_NEAR(position, 3 * 0.25 / 2, 1e-12) << "and ends at the last set-point";
}

// Set-points of an even motion that come up to a millisecond early or late, and now and then one that is missing.
TEST(CyclicInterpolator, SetPointsThatComeUnevenlyDoNotDisturbTheMotion) {
  std::mt19937 random(1);
  CyclicInterpolator steps;
  steps.start(0);
  constexpr double kSpeed = 0.5, kInterval = 0.004, kStep = 0.001;
  double before = 0;
  int next = 0, due = 0;
  for (int tick = 0; tick < 100'000; ++tick) {
    if (tick >= due) {
      steps.queue(kSpeed * kInterval * next++, kInterval);
      if (random() % 500 == 0) ++next;
      due = 4 * next + static_cast<int>(random() % 3) - 1;
    }
    const double position = steps.step(kStep).position;
    if (tick > 100) {
      ASSERT_NEAR(position - before, kSpeed * kStep, 4 * kSpeed * kInterval) << tick;
    }
    before = position;
  }
}

}  // namespace
}  // namespace foresight::sim::motor_test
