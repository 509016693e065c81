#include "prediction/robot_future.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/statistics.hpp"
#include "tests/prediction/future_world.hpp"
#include "tests/support/allocations.hpp"

namespace foresight::robot_future_test {
namespace {

const std::vector<std::string> kNames{"turn", "wave"};

struct Judged {
  double p95 = 0, hold_p95 = 0, inside = 0;  // rad; of both joints
  std::size_t count = 0, invalid = 0;
};

// Of the pictures from the first one of that index on, but for those whose time has not come.
Judged judge(const FutureWorld& world, std::size_t first) {
  std::vector<double> errors, hold;
  std::size_t inside = 0, invalid = 0;
  const Duration age = world.now() - world.pictures().back().time;
  for (std::size_t k = first; k < world.pictures().size(); ++k) {
    const PredictedRobot& shown = world.pictures()[k];
    if (shown.time > world.now()) break;
    if (shown.status == StateStatus::invalid) {
      ++invalid;
      continue;
    }
    const JointValues truth = world.truth_at(shown.time), last = world.truth_at(shown.time + age + age);
    for (std::size_t i = 0; i < 2; ++i) {
      errors.push_back(std::abs(shown.position[i] - truth[i]));
      hold.push_back(std::abs(last[i] - truth[i]));
      inside += errors.back() <= 2 * shown.sigma[i] ? 1 : 0;
    }
  }
  return {quantile(errors, 0.95), quantile(hold, 0.95),
          static_cast<double>(inside) / static_cast<double>(std::max<std::size_t>(errors.size(), 1)), errors.size(),
          invalid};
}

TEST(RobotFuture, ShowsWhereTheRobotWillBe) {
  FutureWorld world;
  world.run(10);
  const std::size_t learnt = world.pictures().size();
  world.run(30);
  const Judged judged = judge(world, learnt);
  EXPECT_GT(judged.count, 3000u);
  EXPECT_EQ(judged.invalid, 0u);
  EXPECT_LT(judged.p95, 0.001);
  EXPECT_GT(judged.hold_p95, 100 * judged.p95);
  EXPECT_GE(judged.inside, 0.90);
  EXPECT_LE(judged.inside, 0.98);
  EXPECT_NEAR(world.future().delay().seconds, 0.3, 1e-6);
  EXPECT_NEAR(world.future().figures(0).lag, 0.015, 0.006);
}

// Set-points that came wait until the robot's program looks for them, which reports do not tell.
TEST(RobotFuture, SetPointsThatWaitForTheGateActLater) {
  using namespace std::chrono_literals;
  FutureWorld world({.looks_every = 5});
  world.run(20);
  const std::size_t learnt = world.pictures().size();
  world.run(20);
  double ways = 0, squares = 0;
  for (std::size_t k = learnt; k < world.pictures().size() && world.pictures()[k].time <= world.now(); ++k) {
    const RobotTime time = world.pictures()[k].time;
    const double truth = world.truth_at(time)[0];
    const double speed = (world.truth_at(time + 20ms)[0] - world.truth_at(time - 20ms)[0]) / 0.04;
    ways += speed * (world.pictures()[k].position[0] - truth);
    squares += speed * speed;
  }
  EXPECT_NEAR(ways / squares, 0, 0.0015) << "s by which it is shown ahead; a set-point waits for 8 ms on average";
  EXPECT_GT(world.future().delay().seconds, 0.303);
}

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

TEST(RobotFuture, JitterAndLossWidenItsUncertainty) {
  FutureWorld world({.jitter = 0.03, .loss = 0.03});
  world.run(10);
  const std::size_t learnt = world.pictures().size();
  world.run(30);
  const Judged judged = judge(world, learnt);
  EXPECT_LT(judged.p95, 0.02);
  EXPECT_GT(judged.hold_p95, 15 * judged.p95);
  EXPECT_GE(judged.inside, 0.90);
  EXPECT_LE(judged.inside, 0.985);
  EXPECT_LT(static_cast<double>(judged.invalid), 0.02 * static_cast<double>(judged.count));
}

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
    ASSERT_EQ(now.status, StateStatus::predicted) << to_words(now, kNames);
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

// The robot stops, and is shown as if it went on until that is known. Its drives are as they were.
TEST(RobotFuture, DrivesAreAsSureAfterSetPointsWereLostAsBefore) {
  FutureWorld world({.delay = 0.5, .jitter = 0.02});
  const auto largest_sigma = [&](double time) {
    const std::size_t first = world.pictures().size();
    world.run(time);
    double out = 0;
    for (std::size_t k = first; k < world.pictures().size(); ++k) {
      EXPECT_EQ(world.pictures()[k].status, StateStatus::predicted) << to_words(world.pictures()[k], kNames);
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

TEST(RobotFuture, StopsWhereTheGateStops) {
  FutureWorld world;
  world.wish = [](double t) {
    return t < 10 ? JointValues{0.5 * std::sin(t) - 0.2, 0.3 * std::sin(2 * t)} : JointValues{1.8, 0};
  };
  world.run(16);
  const PredictedRobot& shown = world.pictures().back();
  ASSERT_EQ(shown.status, StateStatus::predicted) << to_words(shown, kNames);
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
  EXPECT_THAT(to_words(held, kNames), testing::HasSubstr("joint 'turn'"));
  EXPECT_NEAR(held.position[0], world.truth_at(world.now() - std::chrono::milliseconds(320))[0], 1e-3)
      << "as last measured";
  world.jammed = false;
  world.run(6);
  EXPECT_EQ(world.pictures().back().status, StateStatus::predicted) << to_words(world.pictures().back(), kNames);
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

TEST(RobotFuture, SaysWhyItCannotKnow) {
  FutureWorld world;
  const auto reason = [&](Duration ahead = Duration{0}) { return world.future().at(world.now() + ahead).reason; };
  EXPECT_EQ(reason(), FutureReason::no_state);
  world.run(10);
  using namespace std::chrono_literals;
  EXPECT_EQ(reason(100ms), FutureReason::none);
  EXPECT_EQ(reason(1s), FutureReason::too_far);
  EXPECT_EQ(world.future().at(world.now() - 20s).reason, FutureReason::hole);
  EXPECT_EQ(world.future().at(world.now() - 1s - 10ms).status, StateStatus::interpolated);
  EXPECT_EQ(world.future().at(RobotTime{1'000'000'000'000} + 8s).status, StateStatus::exact)
      << "reports are of full 20 ms";
  world.edit_report = [](RobotReport& report) { report.doing = GateDoing::away; };
  world.run(1);
  EXPECT_EQ(reason(), FutureReason::not_ready);
  world.edit_report = [](RobotReport& report) { report.newest_set_point += 1'000'000; };
  world.run(1);
  EXPECT_EQ(reason(), FutureReason::strangers);
  world.edit_report = [](RobotReport&) {};
  world.run(3);
  EXPECT_EQ(reason(), FutureReason::none);
  world.robot_silent = true;
  world.run(10);
  const PredictedRobot shown = world.pictures().back();
  EXPECT_EQ(shown.status, StateStatus::invalid);
  EXPECT_EQ(shown.reason, FutureReason::stale) << "10 s without any state";
  EXPECT_THAT(to_words(shown, kNames), testing::HasSubstr("nothing new comes of the robot"));
  EXPECT_TRUE(std::isfinite(shown.position[0]));
  EXPECT_TRUE(std::isinf(shown.sigma[0]));
  const std::size_t began = world.pictures().size();
  world.robot_silent = false;
  world.run(4);
  EXPECT_EQ(reason(), FutureReason::none) << "it comes back";
  EXPECT_GT(world.pictures().size(), began);
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

TEST(RobotFuture, HistoriesThatAreWrongAreRefused) {
  FutureWorld world;
  world.run(5);
  RobotFuture& future = world.future();
  const RobotTime now = world.now();
  RobotReport good;
  good.time = now;
  good.doing = GateDoing::idle;
  good.joints = 2;
  for (std::size_t i = 0; i < 2; ++i) good.joint[i] = {now, 0, {}};
  const auto report = [&](const std::function<void(RobotReport&)>& edit) {
    RobotReport bad = good;
    edit(bad);
    return future.reported(bad, now);
  };
  using namespace std::chrono_literals;
  EXPECT_EQ(report([](RobotReport& r) { r.joints = 3; }), HistoryFault::wrong_joint_count);
  EXPECT_EQ(report([](RobotReport& r) { r.joint[1].position = NAN; }), HistoryFault::not_finite);
  EXPECT_EQ(report([](RobotReport& r) { r.joint[0].set_point.velocity = INFINITY; }), HistoryFault::not_finite);
  EXPECT_EQ(report([](RobotReport& r) { r.speed = NAN; }), HistoryFault::not_finite);
  EXPECT_EQ(report([](RobotReport& r) { r.time = r.time + 5s; }), HistoryFault::other_clock);
  EXPECT_EQ(report([](RobotReport& r) { r.time = RobotTime{5}; }), HistoryFault::other_clock);
  EXPECT_EQ(report([](RobotReport& r) { r.joint[1].time = RobotTime{}; }), HistoryFault::other_clock);
  EXPECT_EQ(report([](RobotReport& r) { r.time = r.time - 1s; }), HistoryFault::out_of_order);
  SentSetPoint set_point{1'000'000, now, 500ms, true, 2, {}};
  const auto send = [&](const std::function<void(SentSetPoint&)>& edit) {
    SentSetPoint bad = set_point;
    edit(bad);
    return future.sent(bad, now);
  };
  EXPECT_EQ(send([](SentSetPoint& s) { s.joints = 1; }), HistoryFault::wrong_joint_count);
  EXPECT_EQ(send([](SentSetPoint& s) { s.position[1] = NAN; }), HistoryFault::not_finite);
  EXPECT_EQ(send([](SentSetPoint& s) { s.number = 3; }), HistoryFault::out_of_order);
  EXPECT_EQ(send([](SentSetPoint& s) { s.sent = s.sent - 2s; }), HistoryFault::out_of_order);
  EXPECT_EQ(send([](SentSetPoint& s) { s.sent = s.sent + 2s; }), HistoryFault::other_clock);
  EXPECT_EQ(send([](SentSetPoint& s) { s.sent = RobotTime{7}; }), HistoryFault::other_clock);
  for (const HistoryFault fault : {HistoryFault::wrong_joint_count, HistoryFault::not_finite,
                                   HistoryFault::out_of_order, HistoryFault::other_clock})
    EXPECT_GT(std::string(to_string(fault)).size(), 10u);
  EXPECT_EQ(future.at(now + 100ms).status, StateStatus::predicted) << "none of it did any harm";
}

TEST(RobotFuture, TheShownInstantGoesOnEvenly) {
  FutureWorld world({.jitter = 0.05, .loss = 0.1});
  world.run(8);
  for (std::size_t k = 200; k < world.pictures().size(); ++k) {
    const double passed = to_seconds(world.pictures()[k].time - world.pictures()[k - 1].time);
    EXPECT_GE(passed, 0.9 * 0.016 - 1e-9);
    EXPECT_LE(passed, 1.1 * 0.016 + 1e-9);
  }
}

TEST(RobotFuture, TheSameTwiceIsTheSameBitForBit) {
  FutureWorld one({.jitter = 0.02, .loss = 0.02}), other({.jitter = 0.02, .loss = 0.02});
  one.run(6);
  other.run(6);
  ASSERT_EQ(one.pictures().size(), other.pictures().size());
  for (std::size_t k = 0; k < one.pictures().size(); ++k) {
    ASSERT_EQ(one.pictures()[k].time, other.pictures()[k].time);
    for (std::size_t i = 0; i < 2 && one.pictures()[k].status == StateStatus::predicted; ++i) {
      ASSERT_EQ(one.pictures()[k].position[i], other.pictures()[k].position[i]);
      ASSERT_EQ(one.pictures()[k].sigma[i], other.pictures()[k].sigma[i]);
    }
  }
}

TEST(RobotFuture, DoesNotAllocateOnceItIsMade) {
  FutureWorld world;
  world.run(6);
  RobotFuture& future = world.future();
  RobotReport report;
  report.doing = GateDoing::following;
  report.joints = 2;
  std::uint64_t number = 1'000'000;
  const std::size_t before = allocations();
  for (int i = 1; i < 200; ++i) {
    const RobotTime now = world.now() + std::chrono::milliseconds(20 * i);
    const SentSetPoint set_point{++number, now, std::chrono::seconds(1), true, 2, {0.001 * i, 0}};
    future.sent(set_point, now);
    report.time = now - std::chrono::milliseconds(5);
    for (std::size_t k = 0; k < 2; ++k) report.joint[k] = {report.time, 0.001 * i, {}};
    future.reported(report, now);
    future.advance(now);
    future.show(future.instant_to_show(now));
    while (future.take_scored()) {
    }
  }
  EXPECT_EQ(allocations(), before);
}

// Who does not know the robot's time for a moment may ask for nonsense: pictures do not stand until its hour has come.
TEST(RobotFuture, AClockThatJumpsTakesNoPictureAlong) {
  FutureWorld world;
  world.run(10);
  RobotFuture& future = world.future();
  const RobotTime now = world.now();
  const Duration ahead = future.instant_to_show(now) - now;
  future.instant_to_show(RobotTime{});
  for (int i = 1; i < 100; ++i) {
    const RobotTime then = now + i * std::chrono::milliseconds(10);
    EXPECT_NEAR(to_seconds(future.instant_to_show(then) - then), to_seconds(ahead), 0.1) << i;
  }
}

TEST(CorrectionBlend, IsOverInTimeAndNeverFasterThanItMay) {
  for (const double jump : {0.01, -0.2, 1.0}) {
    constexpr double kFastest = 1.5, kStep = 0.001;
    CorrectionBlend blend;
    blend.jumped(-jump);
    EXPECT_EQ(blend.offset(), jump) << "what is shown does not move";
    const double longest = CorrectionBlend::kSettled + std::abs(jump) / kFastest;
    double fastest = 0;
    for (double t = 0; t < longest; t += kStep) {
      const double before = blend.offset();
      blend.pass(kStep, kFastest);
      fastest = std::max(fastest, std::abs(blend.offset() - before) / kStep);
    }
    EXPECT_LE(std::abs(blend.offset()), 0.0101 * std::abs(jump)) << jump;
    EXPECT_LE(fastest, std::min(kFastest, 8.2 * std::abs(jump)) * (1 + 1e-9)) << jump;
  }
  CorrectionBlend blend;
  blend.jumped(-0.01);
  blend.pass(CorrectionBlend::kSettled, 10);
  EXPECT_NEAR(blend.offset(), 0.0001, 2e-6);
}

}  // namespace
}  // namespace foresight::robot_future_test
