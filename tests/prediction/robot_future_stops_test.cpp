// A robot that does not go where it was sent: set-points are lost, the gate or a consent stops it, nobody tells.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "tests/prediction/judged_future.hpp"

namespace foresight::robot_future_stops_test {
namespace {

// The robot follows set-points no more for a while that were shown as if it did.
TEST(RobotFuture, WhatWasShownWronglyIsCorrectedWithoutAJump) {
  FutureWorld world;
  world.run(12);
  world.wish = [](double t) { return JointValues{-0.9 + 0.6 * (t - 12), 0}; };
  world.line_cut_down = true;
  world.run(0.12);
  world.line_cut_down = false;
  const std::size_t first = world.pictures().size();
  world.run(1.5);
  double largest = 0, worst = 0;
  for (std::size_t k = first; k < world.pictures().size(); ++k) {
    const PredictedRobot &before = world.pictures()[k - 1], &now = world.pictures()[k];
    ASSERT_EQ(now.status, StateStatus::predicted) << to_words(now, kFutureNames);
    const double passed = to_seconds(now.time - before.time);
    for (std::size_t i = 0; i < 2; ++i) {
      const double fastest = world.gate().options().joints[i].limits.velocity;
      largest = std::max(largest, std::abs(now.position[i] - before.position[i]) / (fastest * passed));
    }
    if (now.time <= world.now()) worst = std::max(worst, std::abs(now.position[0] - world.truth_at(now.time)[0]));
  }
  EXPECT_GT(worst, 0.02) << "there was something to correct";
  EXPECT_LT(largest, 2.05) << "the robot's own speed, and as much for the correction";
  // The first report of the gap comes 0.3 s after it, and its correction takes 0.3 s.
  const Judged after = judge(world, first + static_cast<std::size_t>(0.8 / 0.016));
  EXPECT_LT(after.p95, 0.004) << "the responses' means of 2 s still know of it";
}

TEST(RobotFuture, StopsWhereTheGateStops) {
  FutureWorld world;
  world.wish = [](double t) {
    return t < 10 ? JointValues{0.5 * std::sin(t) - 0.2, 0.3 * std::sin(2 * t)} : JointValues{1.8, 0};
  };
  world.run(16);
  const PredictedRobot& shown = world.pictures().back();
  ASSERT_EQ(shown.status, StateStatus::predicted) << to_words(shown, kFutureNames);
  EXPECT_TRUE(shown.blocked);
  EXPECT_TRUE(world.gate().state().blocked);
  EXPECT_LT(world.gate().state().motion[0].position, 1.2);
  EXPECT_NEAR(shown.position[0], world.truth_at(world.now())[0], 2e-4);
}

double farthest_off(const FutureWorld& world, std::size_t from = 0) {
  double out = 0;
  for (std::size_t k = from; k < world.pictures().size(); ++k) {
    const PredictedRobot& shown = world.pictures()[k];
    if (shown.status == StateStatus::invalid || shown.time > world.now()) continue;
    const JointValues truth = world.truth_at(shown.time);
    for (std::size_t i = 0; i < 2; ++i) out = std::max(out, std::abs(shown.position[i] - truth[i]));
  }
  return out;
}

// As after an outage: the robot stands, whatever is sent, until somebody agrees.
TEST(RobotFuture, ARobotThatAsksForAnotherConsentStands) {
  FutureWorld world({.consent = 7, .named = 6});
  world.run(4);
  EXPECT_LT(std::abs(world.gate().state().motion[0].position), 1e-9) << "it moved: the test shows nothing";
  EXPECT_LT(farthest_off(world), 1e-3);
  FutureWorld agreed({.consent = 7, .named = 7});
  agreed.run(4);
  EXPECT_GT(std::abs(agreed.gate().state().motion[0].position), 0.1);
}

// The robot told of the new consent before it saw the switch open, though that came later than reports of the time
// after: it is no older consent for that.
TEST(RobotFuture, WhoPressesAgainAfterALossIsFollowedAtOnce) {
  FutureWorld world({.consent = 7, .named = 7, .agrees = true, .tells_every = 1, .tells_late = 0.2});
  world.holds = [](double t) { return t > 0.2 && !(t > 3.8 && t < 4.6); };
  world.run(3);
  const double lasted = std::exchange(world.lasts, 0.1);  // they expire on their way
  world.run(0.5);
  world.lasts = lasted;
  world.run(0.8);
  const std::size_t begin = world.pictures().size();
  const double stood = world.truth_at(world.now())[0];
  world.run(1.7);
  EXPECT_GT(std::abs(world.truth_at(world.now())[0] - stood), 0.1) << "it did not move: the test shows nothing";
  EXPECT_LT(farthest_off(world, begin), 0.01);
}

// Reports of a robot that has lost its operator go on naming the last set-point that came, and the new consent: that
// this one has expired is no other loss.
TEST(RobotFuture, WhoPressesOnceTheLineIsBackIsFollowedAtOnce) {
  FutureWorld world({.delay = 0.2, .consent = 7, .named = 7, .agrees = true});
  constexpr double kPressed = 4.26;  // no report has come yet that has seen a set-point after the gap
  world.holds = [](double t) { return t > 0.2 && !(t > 3.3 && t < kPressed); };
  world.wish = [](double t) { return JointValues{t < kPressed ? 0.2 : 0.2 + 0.5 * std::sin(3 * (t - kPressed)), 0}; };
  world.run(3);
  world.robot_silent = world.line_cut_down = true;
  world.sends = false;
  world.run(1);
  world.robot_silent = world.line_cut_down = false;
  world.run(0.22);
  world.sends = true;
  const std::size_t begin = world.pictures().size();
  world.run(0.8);
  EXPECT_GT(std::abs(world.truth_at(world.now())[0] - 0.2), 0.1) << "it did not move: the test shows nothing";
  EXPECT_LT(farthest_off(world, begin), 2e-3);
}

// A new lease knows nothing of the line: the first set-points, the open switch among them, do not last until they come.
TEST(RobotFuture, AnOpenSwitchThatExpiredOnItsWayWasNotSeen) {
  FutureWorld world({.consent = 7, .named = 7});
  world.holds = [](double t) { return t > 1; };
  world.lasts = 0.1;
  world.run(1.1);
  world.lasts = 0.6;
  world.run(4);
  EXPECT_LT(std::abs(world.gate().state().motion[0].position), 1e-9) << "it moved: the test shows nothing";
  EXPECT_LT(farthest_off(world), 1e-3);
  world.holds = [](double t) { return t > 5.5; };
  world.run(4);
  EXPECT_GT(std::abs(world.gate().state().motion[0].position), 0.1) << "let go and pressed again, it follows";
}

// What keeps reports away keeps set-points away: the robot stops, and nobody tells.
TEST(RobotFuture, ThatItMayHaveStoppedIsDoubtedBeforeItIsKnown) {
  FutureWorld world;
  world.run(15);
  int seen = 0, wrong = 0;
  for (int cut = 0; cut < 10; ++cut) {
    const std::size_t began = world.pictures().size();
    const RobotTime cut_at = world.now();
    world.robot_silent = world.line_cut_down = true;
    world.run(2.5);
    for (std::size_t i = began; i < world.pictures().size(); ++i) {
      const PredictedRobot& shown = world.pictures()[i];
      if (shown.time > world.now() || shown.time < cut_at) continue;
      ++seen;
      if (shown.status != StateStatus::predicted) continue;
      const double off = std::abs(shown.position[0] - world.truth_at(shown.time)[0]);
      wrong += off > std::max(2 * shown.sigma[0], 0.02);
    }
    world.robot_silent = world.line_cut_down = false;
    world.run(4.3);
  }
  EXPECT_GT(seen, 800);
  EXPECT_LT(wrong, seen / 50);
  EXPECT_EQ(world.future().at(world.now()).status, StateStatus::predicted);
}

// What moves slowly is not given up at once: how sure the drives have been lately does not make it surer.
TEST(RobotFuture, HowFarItMayHaveStoppedIsTold) {
  FutureWorld world({.known = KnownResponse{0, 0.015, 0.02}});  // surer than was said of them
  world.wish = [](double t) { return JointValues{0.05 * std::sin(0.4 * t), 0.02 * std::sin(0.3 * t)}; };
  world.run(15);
  const std::size_t began = world.pictures().size();
  const RobotTime cut_at = world.now() + seconds(0.8);  // what is shown once that is noticed
  world.robot_silent = world.line_cut_down = true;
  world.run(1.5);
  int off = 0;
  for (std::size_t i = began; i < world.pictures().size(); ++i) {
    const PredictedRobot& shown = world.pictures()[i];
    if (shown.status != StateStatus::predicted || shown.time > world.now() || shown.time < cut_at) continue;
    const double by = std::abs(shown.position[0] - world.truth_at(shown.time)[0]);
    off += by > 0.002;
    EXPECT_LE(by, shown.sigma[0] + 5e-4) << to_seconds(shown.time - cut_at);
  }
  EXPECT_GT(off, 5) << "it was given up at once: the test shows nothing";
}

// Reports are on time, and tell that nothing comes: again and again for so long that the robot stops.
TEST(RobotFuture, WhatShouldHaveComeAndHasNotDoesNotAct) {
  FutureWorld world;
  constexpr double kEvery = 4, kCutFrom = 0.3, kCut = 0.9, kDelay = 0.3, kStops = 0.5;  // s
  // A report that should have told of another set-point, the delay until what it changes is seen, a correction's blend.
  constexpr double kKnown = kCutFrom + kDelay + 0.05 + 2 * kDelay + CorrectionBlend::kSettled;
  world.lasts = kDelay + kStops;
  world.holds = [](double t) { return t < 15 || std::fmod(t, kEvery) < 1.9 || std::fmod(t, kEvery) > 2.1; };
  world.run(24);
  const std::size_t began = world.pictures().size();
  const double offset = world.t() - to_seconds(world.now() - RobotTime{});
  while (world.t() < 48) {
    const double phase = std::fmod(world.t(), kEvery);
    world.line_cut_down = phase > kCutFrom && phase < kCutFrom + kCut;
    world.run(0.02);
  }
  int seen = 0, wrong = 0;
  for (const PredictedRobot& shown : std::span(world.pictures()).subspan(began)) {
    const double phase = std::fmod(to_seconds(shown.time - RobotTime{}) + offset, kEvery);
    if (shown.time > world.now() || phase < kKnown || phase > kKnown + kStops) continue;
    ++seen;
    wrong += std::abs(shown.position[0] - world.truth_at(shown.time)[0]) > 0.02;
  }
  EXPECT_GT(seen, 100);
  EXPECT_LT(wrong, seen / 10) << "how long the first gap is nobody can know";
}

// Reports are on time, and tell that nothing comes: whether it comes before the robot stops nobody knows at first.
TEST(RobotFuture, HowFarWhatIsHeldUpWouldTakeItIsTold) {
  FutureWorld world;
  constexpr double kDelay = 0.3, kGap = 0.9, kSeen = 0.75, kStops = 1;  // s
  world.lasts = kDelay + kStops;
  world.wish = [](double t) { return JointValues{0.8 * std::sin(0.5 * t), 0.5 * std::sin(1.7 * t)}; };
  world.run(18);
  world.line_cut_down = true;
  world.run(kGap);
  world.line_cut_down = false;
  world.run(2 * kDelay + kSeen - kGap);
  const PredictedRobot told = world.future().at(world.now() + seconds(world.future().delay().seconds));
  const double left = std::abs(world.wish(world.t())[0] - told.position[0]);
  ASSERT_EQ(told.status, StateStatus::predicted);
  EXPECT_GT(left, 0.05) << "it would be there anyway: the test shows nothing";
  EXPECT_GT(told.sigma[0], 0.45 * left) << "as likely as not";
  world.run(2 * kDelay);
  const double off = std::abs(told.position[0] - world.truth_at(told.time)[0]);
  EXPECT_LT(off, 2 * told.sigma[0]);
}

// A line that stands still for less long than a set-point lasts, again and again: the robot went on each time.
TEST(RobotFuture, ReportsThatAreLateAsOftenBeforeAreNoStop) {
  FutureWorld world;
  world.wish = [](double t) { return JointValues{0.5 * std::sin(t), 0.3 * std::sin(2 * t)}; };
  world.run(15);
  const auto stall = [&world] {
    const std::size_t began = world.pictures().size();
    world.robot_silent = true;
    world.run(0.15);
    world.robot_silent = false;
    world.run(0.85);
    double widest = 0;
    for (std::size_t i = began; i < world.pictures().size(); ++i)
      widest = std::max(widest, world.pictures()[i].sigma[0]);
    return widest;
  };
  const double first = stall();
  for (int i = 0; i < 15; ++i) stall();
  EXPECT_GT(first, 0.02) << "it may have stopped";
  EXPECT_LT(stall(), 0.2 * first);
}

}  // namespace
}  // namespace foresight::robot_future_stops_test
