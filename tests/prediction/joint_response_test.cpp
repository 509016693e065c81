#include "prediction/joint_response.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include "common/statistics.hpp"
#include "tests/support/allocations.hpp"

namespace foresight::joint_response_test {
namespace {

constexpr double kTick = 0.0005;  // s of the emulated shaft

struct Drive {
  double dead_time = 0.01, lag = 0.03;
  double overshoot = 0;  // > 0: a second pole pair with that little damping instead of the lag
  double command_step = 0.004, state_step = 0.004;
  double quantum = 2e-5, offset = 0.005;  // rad
  double jitter = 0;                      // of the states' times, as a share of their step
  double friction = 0;                    // rad of following error that it takes to move
  double fastest = 1e9;                   // rad/s
};

double wish(double t) {  // rad
  return 0.4 * std::sin(1.1 * t) + 0.2 * std::sin(2.7 * t + 1) + 0.08 * std::sin(6.1 * t + 2);
}

// The shaft on the commands' every step, held in between.
std::vector<double> shaft(const Drive& drive, double seconds) {
  std::vector<double> positions;
  double position = wish(0), velocity = 0;
  for (int i = 0; i * kTick < seconds; ++i) {
    const double acting = std::max(0.0, i * kTick - drive.dead_time);
    const double off = wish(std::floor(acting / drive.command_step + 1e-9) * drive.command_step) - position;
    if (drive.overshoot > 0) {
      const double pole = 1 / drive.lag;
      velocity += (pole * pole * off - 2 * drive.overshoot * pole * velocity) * kTick;
    } else {
      velocity = std::copysign(std::max(0.0, std::abs(off) - drive.friction), off) / drive.lag;
    }
    velocity = std::clamp(velocity, -drive.fastest, drive.fastest);
    position += velocity * kTick;
    positions.push_back(position);
  }
  return positions;
}

struct Outcome {
  ResponseFigures figures;
  std::array<double, 3> p95{}, inside{};
  double increment_p95 = 0;  // at 0.3 s
  double largest_speed = 0;
};

// Learns for 8 s of 20, then predicts 0.1, 0.3 and 1 s ahead.
Outcome run(const Drive& drive) {
  constexpr double kSeconds = 20, kLearning = 8;
  const std::vector<double> truth = shaft(drive, kSeconds + 2);
  const auto truth_at = [&](double t) { return truth[static_cast<std::size_t>(std::lround(t / kTick))]; };
  const auto measured = [&](double t) {
    return std::round(truth_at(t) / drive.quantum) * drive.quantum + drive.offset;
  };
  std::mt19937 random(4);
  std::uniform_real_distribution<double> any(-0.5, 0.5);
  JointResponse response;
  std::array<std::vector<double>, 3> errors;
  std::vector<double> increments;
  std::array<std::size_t, 3> inside{};
  bool learnt = false;
  int command = 0;
  for (int i = 1; i * drive.state_step < kSeconds; ++i) {
    const double t = (i + drive.jitter * any(random)) * drive.state_step;
    for (; command * drive.command_step <= t + 1.1; ++command)
      response.command(command * drive.command_step, wish(command * drive.command_step));
    response.observe(t, measured(t));
    if (t < kLearning) continue;
    if (!std::exchange(learnt, true)) {
      EXPECT_TRUE(response.identify());
    }
    std::size_t h = 0;
    for (const double ahead : {0.1, 0.3, 1.0}) {
      const PredictedPosition predicted = response.at(t + ahead);
      EXPECT_TRUE(predicted.valid);
      const double off = std::abs(predicted.position - measured(t + ahead));
      errors[h].push_back(off);
      inside[h++] += off <= 2 * predicted.sigma;
    }
    increments.push_back(std::abs(measured(t) + wish(t + 0.3) - wish(t) - measured(t + 0.3)));
  }
  Outcome outcome{response.figures(), {}, {}, quantile(increments, 0.95), response.largest_speed()};
  for (std::size_t h = 0; h < 3; ++h) {
    outcome.p95[h] = quantile(errors[h], 0.95);
    outcome.inside[h] = static_cast<double>(inside[h]) / static_cast<double>(errors[h].size());
  }
  return outcome;
}

void expect_predicted(const Outcome& outcome, double most, const char* what) {
  for (std::size_t h = 0; h < 3; ++h) {
    EXPECT_LT(outcome.p95[h], most) << what << " " << h;
    EXPECT_GE(outcome.inside[h], 0.88) << what << " " << h;
    EXPECT_LE(outcome.inside[h], 0.995) << what << " " << h;
  }
  EXPECT_LT(10 * outcome.p95[1], outcome.increment_p95) << what;
}

TEST(JointResponse, FindsDelayAndLagWithinItsUncertainty) {
  const Outcome outcome = run({});
  // The command is held for 4 ms: 2 ms more on average.
  EXPECT_NEAR(outcome.figures.delay, 0.042, 3 * outcome.figures.delay_sigma);
  EXPECT_LT(outcome.figures.delay_sigma, 0.003);
  EXPECT_NEAR(outcome.figures.lag, 0.03, 0.006);
  EXPECT_NEAR(outcome.figures.dead_time, 0.012, 0.006);
  expect_predicted(outcome, 0.0005, "lag");
}

TEST(JointResponse, DrivesOfManyKindsArePredicted) {
  expect_predicted(run({.dead_time = 0.25, .lag = 0.04}), 0.001, "far away");
  expect_predicted(run({.lag = 0.025, .overshoot = 0.4}), 0.0005, "overshoot");
  expect_predicted(run({.quantum = 1e-3}), 0.0015, "coarse encoder");
  expect_predicted(run({.command_step = 0.02, .state_step = 0.02, .jitter = 0.5}), 0.003, "slow, at uneven times");
  expect_predicted(run({.state_step = 0.001}), 0.0005, "fast states");
  expect_predicted(run({.friction = 0.002}), 0.004, "friction");
}

// Where the shaft was between two states is not known.
TEST(JointResponse, IsLearntFromTheFewStatesOfAThinLine) {
  for (const double step : {0.06, 0.08, 0.1, 0.13}) {
    const Outcome outcome = run({.state_step = step, .jitter = 0.3});
    EXPECT_NEAR(outcome.figures.delay, 0.042, 3 * outcome.figures.delay_sigma) << step;
    EXPECT_LT(outcome.figures.delay_sigma, 0.005) << step;
    for (const double p95 : outcome.p95) EXPECT_LT(p95, 0.0005) << step;
    EXPECT_LT(10 * outcome.p95[1], outcome.increment_p95) << step;
    EXPECT_TRUE(std::isinf(outcome.largest_speed)) << step;
  }
  EXPECT_NEAR(run({.lag = 0.02, .state_step = 0.08, .fastest = 0.7}).largest_speed, 0.7, 0.05);
}

// Its commands ask for up to 1.4 rad/s.
TEST(JointResponse, ADriveAtItsLargestSpeedIsPredicted) {
  for (const double fastest : {0.7, 1.0}) {
    const Outcome outcome = run({.lag = 0.02, .fastest = fastest});
    EXPECT_NEAR(outcome.largest_speed, fastest, 0.05 * fastest);
    for (const double p95 : outcome.p95) EXPECT_LT(p95, 0.006) << fastest;
    for (const double inside : outcome.inside) EXPECT_GE(inside, 0.85) << fastest;
    EXPECT_LT(10 * outcome.p95[1], outcome.increment_p95) << fastest;
  }
  EXPECT_TRUE(std::isinf(run({}).largest_speed)) << "one that follows has none";
}

TEST(JointResponse, FarTargetsOfADriveWithARampOfItsOwnArePredicted) {
  constexpr double kFastest = 0.5, kStep = 0.01;
  JointResponse response;
  std::mt19937 random(2);
  std::uniform_real_distribution<double> anywhere(-1, 1);
  double target = 0, position = 0, worst = 0;
  for (int i = 1; i < 4000; ++i) {
    if (i % 150 == 1) {
      target = anywhere(random);
      response.command(i * kStep, target);
    }
    position += std::clamp(target - position, -kFastest * kStep, kFastest * kStep);
    response.observe((i + 1) * kStep, position);
    if (i % 500 == 0) response.identify();
    // No other target comes within the next 0.3 s.
    if (i > 2500 && i % 150 < 100 && i % 150 > 5) {
      double then = position;
      for (int k = 0; k < 30; ++k) then += std::clamp(target - then, -kFastest * kStep, kFastest * kStep);
      worst = std::max(worst, std::abs(response.at((i + 31) * kStep).position - then));
    }
  }
  EXPECT_NEAR(response.largest_speed(), kFastest, 0.03);
  EXPECT_LT(worst, 0.03);
}

TEST(JointResponse, NothingIsLearntFromStandingStillOrTooLittle) {
  JointResponse response;
  EXPECT_FALSE(response.identify());
  for (int i = 0; i < 20'000; ++i) {
    response.command(i * 0.001, 1);
    response.observe(i * 0.001, 1.02);
  }
  EXPECT_FALSE(response.identify());
  EXPECT_EQ(response.figures().samples, 0u);
  EXPECT_NEAR(response.at(19.999).position, 1.02, 1e-9);
}

TEST(JointResponse, WhatIsWrongIsNotTakenAndWhatIsOldSaysNothing) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  JointResponse response;
  EXPECT_FALSE(response.at(0).valid);
  EXPECT_FALSE(response.observe(0, 0)) << "no command yet";
  EXPECT_FALSE(response.command(0, kNan));
  EXPECT_FALSE(response.command(kNan, 0));
  EXPECT_TRUE(response.command(1, 0.5));
  EXPECT_FALSE(response.command(1, 0.6));
  EXPECT_FALSE(response.command(0.5, 0.6));
  EXPECT_FALSE(response.observe(1, std::numeric_limits<double>::infinity()));
  EXPECT_TRUE(response.observe(1, 0.4));
  EXPECT_FALSE(response.observe(0.9, 0.4));
  EXPECT_NEAR(response.at(1.2).position, 0.4, 1e-12);
  EXPECT_FALSE(response.at(0.9).valid);
  EXPECT_FALSE(response.at(10).valid);
  EXPECT_FALSE(response.at(kNan).valid);
}

TEST(JointResponse, CommandsAfterTheWantedInstantDoNotMatter) {
  JointResponse some, more;
  for (int i = 0; i < 1000; ++i) {
    for (JointResponse* response : {&some, &more}) {
      response->command(i * 0.01, wish(i * 0.01));
      response->observe(i * 0.01, wish(i * 0.01 - 0.03));
    }
  }
  EXPECT_TRUE(some.identify());
  EXPECT_TRUE(more.identify());
  for (int i = 1000; i < 1010; ++i) some.command(i * 0.01, 0.2);
  for (int i = 1000; i < 1100; ++i) more.command(i * 0.01, i < 1010 ? 0.2 : 7);
  EXPECT_EQ(some.at(10.093).position, more.at(10.093).position);
}

TEST(JointResponse, AllocatesNothing) {
  JointResponse response;
  const std::size_t before = allocations();
  for (int i = 0; i < 3000; ++i) {
    response.command(i * 0.004, wish(i * 0.004));
    response.observe(i * 0.004, wish(i * 0.004 - 0.02));
    if (i % 1000 == 999) {
      EXPECT_TRUE(response.identify());
    }
  }
  response.at(12.1);
  EXPECT_EQ(allocations(), before);
}

}  // namespace
}  // namespace foresight::joint_response_test
