#include "prediction/robot_future.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ranges>
#include <span>

#include "tests/prediction/judged_future.hpp"
#include "tests/support/allocations.hpp"

namespace foresight::robot_future_test {
namespace {

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

// While no set-point arrives, the newest one that came gets older and older; those that will come do not take longer.
TEST(RobotFuture, ALineThatStandsStillIsNotLearntAsASlowOne) {
  FutureWorld world;
  world.run(10);
  const double usual = world.future().delay().seconds;
  world.line_cut_down = true;
  world.run(3);
  world.line_cut_down = false;
  world.run(0.8);  // until reports tell of set-points again
  EXPECT_NEAR(world.future().delay().seconds, usual, 0.004);
}

// The instant that is shown would lie beyond all that is known until it had fallen back by 0.3 s.
TEST(RobotFuture, PicturesWaitForALineThatBecameFaster) {
  FutureWorld world;
  world.lasts = 1;
  world.slower = 0.3;
  world.run(10);
  world.slower = 0;
  const std::size_t before = world.pictures().size();
  world.run(4);
  const std::span<const PredictedRobot> after = std::span(world.pictures()).subspan(before);
  const auto unknown = std::ranges::count(after, FutureReason::too_far, &PredictedRobot::reason);
  EXPECT_LT(unknown, std::ssize(after) / 10);
  EXPECT_TRUE(std::ranges::is_sorted(after, {}, &PredictedRobot::time));
  EXPECT_NEAR(to_seconds(after.back().time - world.now()), 0.3, 0.02);
}

// Each time the robot stops, and nobody can know of it before a report comes. Its drives are as well known as before.
TEST(RobotFuture, GapsOfCommandsDoNotTakeTheTrustInDrives) {
  FutureWorld world;
  constexpr double kEvery = 3;
  world.holds = [](double t) { return t < 10 || std::fmod(t, kEvery) < 2.2 || std::fmod(t, kEvery) > 2.4; };
  world.run(10);
  const std::size_t before = world.pictures().size();
  while (world.t() < 40) {
    const double phase = std::fmod(world.t(), kEvery);
    world.line_cut_down = phase > 1 && phase < 1.7;
    world.run(0.02);
  }
  const std::span<const PredictedRobot> after = std::span(world.pictures()).subspan(before);
  EXPECT_LT(std::ranges::count(after, FutureReason::unsure, &PredictedRobot::reason), std::ssize(after) / 20);
}

// What was on its way then acts sooner or later than was expected, whatever the drives.
using namespace std::chrono_literals;

TEST(RobotFuture, ALineThatBecomesAnotherOneDoesNotTakeTheTrustInDrives) {
  FutureWorld world;
  constexpr double kEvery = 3;
  world.lasts = 1;
  world.run(10);
  const double sigma = world.pictures().back().sigma[0];
  while (world.t() < 40) {
    world.slower = std::fmod(world.t(), 2 * kEvery) < kEvery ? 0.3 : 0;
    world.run(0.02);
  }
  EXPECT_TRUE(world.future().was_surprised(world.now() - 800ms)) << "three tenths of a second after it became slower";
  world.run(5);
  EXPECT_FALSE(world.future().was_surprised(world.now() - 7s)) << "only the last time is remembered";
  EXPECT_FALSE(world.future().was_surprised(world.now() - 1s));
  EXPECT_LT(world.pictures().back().sigma[0], 2 * sigma);
}

// As when a line that stood still gives out what it held, the oldest first.
TEST(RobotFuture, ReportsThatComeTooOldAreNoNews) {
  FutureWorld world;
  world.run(10);
  const RobotTime begin = world.now();
  world.edit_report = [begin](RobotReport& report) {
    const Duration late = std::max(Duration{0}, (report.time - begin) * 9 / 10);
    report.time = report.time - late;
    report.newest_came = report.newest_came - late;
    for (ReportedJoint& joint : report.joint) joint.time = joint.time - late;
    report.joint[1].time = report.joint[1].time - std::min<Duration>(late, 300ms);
  };
  world.run(2);
  EXPECT_EQ(world.future().at(world.now()).reason, FutureReason::none);
  const std::size_t before = world.pictures().size();
  world.run(2);
  EXPECT_EQ(world.future().at(world.now()).reason, FutureReason::stale);
  EXPECT_TRUE(std::ranges::none_of(std::span(world.pictures()).subspan(before), [](const PredictedRobot& shown) {
    return shown.reason == FutureReason::too_far;
  })) << "of a joint that tells of itself later than others";
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
  EXPECT_THAT(to_words(shown, kFutureNames), testing::HasSubstr("nothing new comes of the robot"));
  EXPECT_TRUE(std::isfinite(shown.position[0]));
  EXPECT_TRUE(std::isinf(shown.sigma[0]));
  const std::size_t began = world.pictures().size();
  world.robot_silent = false;
  world.run(4);
  EXPECT_EQ(reason(), FutureReason::none) << "it comes back";
  EXPECT_GT(world.pictures().size(), began);
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
