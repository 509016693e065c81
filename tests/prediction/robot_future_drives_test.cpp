// What the prediction learns of drives, and of what holds them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/statistics.hpp"
#include "tests/prediction/judged_future.hpp"

namespace foresight::robot_future_drives_test {
namespace {

// While joints look for home, or the operator for his glasses, nothing can be learnt of drives.
TEST(RobotFuture, DrivesAreLearntOnceTheyMoveHoweverLateThatIs) {
  FutureWorld world({.lag = 0.06});
  const auto moves = world.wish;
  world.wish = [&](double t) {
    return t < 20 ? JointValues{} : JointValues{0.7 * (moves(t - 20)[0] + 0.3), moves(t - 20)[1]};
  };
  world.run(20);
  EXPECT_EQ(world.future().figures(0).samples, 0u) << "it did not move";
  double learnt_after = 0;
  const auto samples = [&] { return std::min(world.future().figures(0).samples, world.future().figures(1).samples); };
  for (; samples() == 0 && learnt_after < 5; learnt_after += 0.1) world.run(0.1);
  EXPECT_LT(learnt_after, 3) << "of which 0.6 s are the line's";
  const std::size_t learnt = world.pictures().size();
  world.run(5);
  const Judged judged = judge(world, learnt);
  EXPECT_LT(judged.p95, 0.003);
  EXPECT_GE(judged.inside, 0.90) << "little was seen of the drives yet, and that is told";
}

double median_sigma(const FutureWorld& world) {
  std::vector<double> sigmas;
  for (const PredictedRobot& shown : world.pictures())
    if (shown.status == StateStatus::predicted) sigmas.push_back(shown.sigma[0]);
  return median(sigmas);
}

TEST(RobotFuture, DrivesThatAreKnownArePredictedFromTheirFirstMotionOn) {
  FutureWorld unknown({.lag = 0.06});
  FutureWorld known({.lag = 0.06, .known = KnownResponse{.dead_time = 0, .lag = 0.06, .sigma = 0.002}});
  unknown.run(3);
  known.run(3);
  EXPECT_LT(judge(known, 0).p95, 0.003);
  EXPECT_GT(judge(unknown, 0).p95, 5 * judge(known, 0).p95);
  EXPECT_GE(judge(known, 0).inside, 0.90);
  EXPECT_LT(5 * median_sigma(known), median_sigma(unknown));
}

// Another drive was put in, or another load.
TEST(RobotFuture, WhatWasKnownOfDrivesGivesWayToWhatIsSeen) {
  FutureWorld world({.known = KnownResponse{.dead_time = 0.05, .lag = 0.02, .sigma = 0.002}});
  world.run(10);
  const std::size_t learnt = world.pictures().size();
  world.run(10);
  const Judged judged = judge(world, learnt);
  EXPECT_LT(judged.p95, 0.001);
  EXPECT_GE(judged.inside, 0.90);
  EXPECT_EQ(judged.invalid, 0u);
}

// The robot stops, and is shown as if it went on until that is known. Its drives are as they were.
TEST(RobotFuture, DrivesAreAsSureAfterSetPointsWereLostAsBefore) {
  FutureWorld world({.delay = 0.5, .jitter = 0.02});
  const auto largest_sigma = [&](double time) {
    const std::size_t first = world.pictures().size();
    world.run(time);
    double out = 0;
    for (std::size_t k = first; k < world.pictures().size(); ++k) {
      EXPECT_EQ(world.pictures()[k].status, StateStatus::predicted) << to_words(world.pictures()[k], kFutureNames);
      out = std::max(out, world.pictures()[k].sigma[0]);
    }
    return out;
  };
  world.run(12);
  const double before = largest_sigma(2);
  world.line_cut_down = true;
  world.run(0.3);
  world.line_cut_down = false;
  world.run(2);  // until it is known, and corrected
  EXPECT_LT(largest_sigma(6), 1.5 * before);
}

TEST(RobotFuture, WhatHoldsAJointIsNoticed) {
  FutureWorld world;
  world.run(12);
  ASSERT_EQ(world.pictures().back().status, StateStatus::predicted);
  world.jammed = true;
  // As long as the set-points stay within the following error: the drives do not fault.
  world.run(0.3 + 0.35);
  const PredictedRobot& held = world.pictures().back();
  EXPECT_EQ(held.status, StateStatus::invalid);
  EXPECT_EQ(held.reason, FutureReason::astray);
  EXPECT_EQ(held.joint, 0);
  EXPECT_THAT(to_words(held, kFutureNames), testing::HasSubstr("joint 'turn'"));
  EXPECT_NEAR(held.position[0], world.truth_at(world.now() - std::chrono::milliseconds(320))[0], 1e-3)
      << "as last measured";
  world.jammed = false;
  world.run(6);
  EXPECT_EQ(world.pictures().back().status, StateStatus::predicted) << to_words(world.pictures().back(), kFutureNames);
}

// Drives are identified one after the other, so that it depends on when a joint is held what was learnt of that.
TEST(RobotFuture, NothingIsLearntOfWhatHoldsAJoint) {
  for (const double later : {0.0, 0.25, 0.5, 0.75}) {
    SCOPED_TRACE(later);
    FutureWorld world;
    world.run(7 + later);
    const double free = world.future().figures(0).unexplained;
    world.jammed = true;
    world.run(0.3 + 0.35);
    ASSERT_EQ(world.pictures().back().reason, FutureReason::astray);
    EXPECT_LT(world.future().figures(0).unexplained, 1.5 * free);
    world.jammed = false;
    world.run(5);  // the means of 2 s know of it
    const std::size_t again = world.pictures().size();
    world.run(3);
    EXPECT_LT(world.future().figures(0).unexplained, 1.5 * free);
    EXPECT_LT(judge(world, again).p95, 0.001);
  }
}

TEST(RobotFuture, JawsThatHoldSomethingAreMeasuredAndTheArmIsPredicted) {
  FutureWorld world({.jaws = true});
  world.run(12);
  world.jammed = true;
  world.run(0.3 + 0.35);
  const PredictedRobot held = world.pictures().back();
  EXPECT_EQ(held.status, StateStatus::predicted);
  EXPECT_TRUE(std::isinf(held.sigma[0]));
  EXPECT_NEAR(held.position[0], world.truth_at(world.now())[0], 1e-3) << "it stands where it was measured";
  world.jammed = false;
  world.run(6);
  EXPECT_LT(held.sigma[1], 0.02);
  EXPECT_NEAR(held.position[1], world.truth_at(held.time)[1], 2 * held.sigma[1] + 1e-3);
  EXPECT_TRUE(std::isfinite(world.pictures().back().sigma[0]));
}

}  // namespace
}  // namespace foresight::robot_future_drives_test
