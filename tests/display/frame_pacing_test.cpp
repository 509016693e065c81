// Frames are paced by instants alone: displays, late sleeps and slow drawings are schedules.
#include "display/frame_pacing.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "common/statistics.hpp"
#include "texture_gpu/slice_budget.hpp"

namespace foresight::frame_pacing_test {
namespace {

using namespace std::chrono_literals;

/// What a frame meets. Times in ms.
struct World {
  double refresh = 0;  // of a display that holds swaps; 0: it does not
  double phase = 3.7;  // of its refreshes
  double swap = 0.1;   // that a swap takes without waiting
  double draw = 6, draw_jitter = 1;
  double sleep_jitter = 0.3;  // sleeps end so late, at most
  double display_jitter = 0.05;
  double late = 0;          // the thread goes on so long after the display took the frame
  bool work_waits = false;  // for the time between frames, in slices of 2 ms
};

struct Frame {
  double wake = 0, drawn = 0, swapped = 0, target = 0;
  double worked = 0;  // after it
};

double ms(RobotTime t) {
  return 1e-6 * static_cast<double>(t.ns);
}

class Simulation {
 public:
  explicit Simulation(const FramePacingOptions& options, double start_ms = 1e3)
      : now_(start_ms), pacing_(options, RobotTime{std::llround(1e6 * start_ms)}) {}

  std::vector<Frame> run(const World& world, int frames) {
    std::vector<Frame> out;
    for (int i = 0; i < frames; ++i) {
      Frame frame;
      frame.target = ms(pacing_.target());
      now_ = std::max(now_, ms(pacing_.wake())) + world.sleep_jitter * uniform();
      frame.wake = now_;
      frame.drawn = now_ += world.draw + world.draw_jitter * uniform();
      pacing_.drawn(at(now_));
      now_ += world.swap;
      if (world.refresh > 0)
        now_ = world.phase + world.refresh * std::ceil((now_ - world.phase) / world.refresh) +
               world.display_jitter * uniform();
      now_ += world.late;
      frame.swapped = now_;
      pacing_.swapped(at(now_), world.work_waits ? budget_.rest_due(at(now_)) : Duration{0});
      budget_.frame_ends(at(now_), pacing_.wake());
      if (world.work_waits) frame.worked = work_until(ms(pacing_.wake()));
      budget_.frame_begins(pacing_.wake());
      if (world.work_waits) budget_.wait(pacing_.wake(), "slice");
      out.push_back(frame);
    }
    return out;
  }
  void hold_up(double lasts) { pacing_.held_up(at(now_ += lasts)); }
  FramePacing& pacing() { return pacing_; }

 private:
  static RobotTime at(double t) { return {std::llround(1e6 * t)}; }
  /// For how long slices run.
  double work_until(double wake) {
    double time = now_, worked = 0;
    while (time < wake) {
      const auto until = budget_.wait(at(time), "slice");
      const double end = until ? std::min(ms(*until), wake) : time + kSlice;
      if (!until) budget_.ran(at(time), at(end), "slice"), worked += kSlice;
      time = std::max(end, time + 1e-3);
    }
    return worked;
  }
  double uniform() { return std::uniform_real_distribution<double>(0, 1)(random_); }

  static constexpr double kSlice = 2;
  double now_;
  FramePacing pacing_;
  SliceBudget budget_;
  std::mt19937 random_{7};
};

std::vector<double> intervals(const std::vector<Frame>& frames) {
  std::vector<double> out;
  for (std::size_t i = 1; i < frames.size(); ++i) out.push_back(frames[i].swapped - frames[i - 1].swapped);
  return out;
}
std::vector<double> latencies(const std::vector<Frame>& frames) {
  std::vector<double> out;
  for (const Frame& frame : frames) out.push_back(frame.swapped - frame.wake);
  return out;
}

FramePacingOptions at_rate(double rate_hz) {
  FramePacingOptions out;
  out.rate_hz = rate_hz;
  return out;
}

TEST(FramePacing, WithoutADisplayFramesComeAtTheRateAsked) {
  Simulation simulation(at_rate(25));
  const auto frames = simulation.run({}, 400);
  EXPECT_NEAR(median(intervals(frames)), 40, 0.1);
  EXPECT_LT(quantile(intervals(frames), 0.99), 42);
  EXPECT_LT(quantile(latencies(frames), 0.99), 8) << "drawn just before it is shown";
  EXPECT_EQ(simulation.pacing().figures().late, 0u);
  EXPECT_EQ(simulation.pacing().figures().phase, PacingPhase::own_clock);
  EXPECT_EQ(simulation.pacing().figures().frames, 400u);
}

// A swap that only takes long (a copy over a socket) is no display: nothing to be in step with.
TEST(FramePacing, ASlowSwapIsNotTakenForADisplay) {
  Simulation simulation(at_rate(30));
  World world;
  world.swap = 2.5;
  const auto frames = simulation.run(world, 600);
  EXPECT_EQ(simulation.pacing().figures().phase, PacingPhase::own_clock);
  EXPECT_NEAR((frames.back().swapped - frames[100].swapped) / 499, 1e3 / 30, 0.05);
}

class FramePacingOnDisplays : public testing::TestWithParam<double> {};

TEST_P(FramePacingOnDisplays, FramesAreInStepAndNew) {
  World world;
  world.refresh = 1e3 / GetParam();
  world.draw = 0.2 * world.refresh;
  world.draw_jitter = 0.05 * world.refresh;
  Simulation simulation(at_rate(GetParam()));
  simulation.run(world, 200);
  ASSERT_EQ(simulation.pacing().figures().phase, PacingPhase::locked);
  EXPECT_NEAR(to_seconds(simulation.pacing().figures().refresh) * 1e3, world.refresh, 0.01);
  const auto before = simulation.pacing().figures();
  const auto frames = simulation.run(world, 2000);
  EXPECT_EQ(simulation.pacing().figures().late, before.late);
  for (const double apart : intervals(frames)) EXPECT_NEAR(apart, world.refresh, 0.1);
  // The pose is as young as the drawing and its reserve allow: not a whole refresh old.
  EXPECT_LT(quantile(latencies(frames), 0.99), 0.25 * world.refresh + 0.4 + 1.5 + 0.3);
}

INSTANTIATE_TEST_SUITE_P(Hz, FramePacingOnDisplays, testing::Values(59.94, 75.0, 144.0),
                         [](const auto& i) { return std::to_string(static_cast<int>(i.param)); });

TEST(FramePacing, ARateBelowTheDisplaysTakesEveryOtherRefresh) {
  World world;
  world.refresh = 1e3 / 60;
  Simulation simulation(at_rate(30));
  simulation.run(world, 200);
  ASSERT_EQ(simulation.pacing().figures().phase, PacingPhase::locked);
  for (const double apart : intervals(simulation.run(world, 500))) EXPECT_NEAR(apart, 1e3 / 30, 0.1);
}

// The thread was not scheduled for some milliseconds, once in so many frames as are looked at together.
TEST(FramePacing, OneLateSwapHidesNoDisplay) {
  for (int place = 0; place < 16; ++place)
    for (const double late : {0.3, 0.45, 0.7, 0.9}) {
      SCOPED_TRACE(testing::Message() << "frame " << place << " of 16 is late by " << late << " refreshes");
      World world;
      world.refresh = 1e3 / 60;
      world.draw = 3;
      Simulation simulation(at_rate(30));
      for (int i = 0; i < 96; ++i) {
        world.late = i % 16 == place ? late * world.refresh : 0;
        simulation.run(world, 1);
      }
      EXPECT_EQ(simulation.pacing().figures().phase, PacingPhase::locked);
      EXPECT_NEAR(std::remainder(1e3 / 30, to_seconds(simulation.pacing().figures().refresh) * 1e3), 0, 0.1);
    }
}

// To another screen, without anybody saying so.
TEST(FramePacing, FollowsARefreshThatChanges) {
  World world;
  world.refresh = 1e3 / 60;
  world.draw = 3;
  Simulation simulation(at_rate(60));
  simulation.run(world, 200);
  for (const double rate : {50.0, 75.0, 59.94}) {
    world.refresh = 1e3 / rate;
    world.phase += 4.1;
    simulation.run(world, 300);
    EXPECT_EQ(simulation.pacing().figures().phase, PacingPhase::locked) << rate;
    EXPECT_NEAR(to_seconds(simulation.pacing().figures().refresh) * 1e3, world.refresh, 0.02) << rate;
  }
  world.refresh = 0;  // it no longer waits for one
  simulation.run(world, 300);
  EXPECT_EQ(simulation.pacing().figures().phase, PacingPhase::own_clock);
}

TEST(FramePacing, AMissedRefreshIsCountedAndTheNextOneMet) {
  World world;
  world.refresh = 1e3 / 60;
  Simulation simulation(at_rate(60));
  simulation.run(world, 200);
  ASSERT_EQ(simulation.pacing().figures().phase, PacingPhase::locked);
  const auto before = simulation.pacing().figures().late;
  for (int i = 0; i < 10; ++i) {
    World slow = world;
    slow.draw = 14;
    simulation.run(slow, 1);
    const auto after = intervals(simulation.run(world, 20));
    EXPECT_LT(quantile(after, 1), 18) << "one miss does not become two";
  }
  EXPECT_EQ(simulation.pacing().figures().late - before, 10u);
  EXPECT_EQ(simulation.pacing().figures().phase, PacingPhase::locked);
}

// A drawing of 30 ms at 40 frames a second: the frames come as fast as they can, a rest stays for what else there is.
TEST(FramePacing, DrawingThatTakesTooLongLeavesARest) {
  World world;
  world.draw = 30;
  Simulation idle(at_rate(40)), busy(at_rate(40));
  EXPECT_NEAR(median(intervals(idle.run(world, 200))), 30.75, 0.5) << "nothing waits: no rest";
  world.work_waits = true;
  const auto frames = busy.run(world, 200);
  double worked = 0;
  for (std::size_t i = 99; i + 1 < frames.size(); ++i) worked += frames[i].worked;
  EXPECT_GE(worked / (frames.back().swapped - frames[99].swapped), 0.32);
  EXPECT_LT(quantile(intervals(frames), 0.99), 1.5 * 35);
  World on_display = world;
  on_display.refresh = 1e3 / 60;
  const auto held = busy.run(on_display, 200);
  EXPECT_LT(quantile(intervals({held.begin() + 100, held.end()}), 0.99), 67 + 0.1);
}

// Drawings of 24 ms at 25 frames a second leave other work more than its third; one of them in ten takes 38.
TEST(FramePacing, WhatWorkHasHadMakesUpForASlowDrawing) {
  Simulation simulation(at_rate(25));
  World world{.draw = 23, .draw_jitter = 0.5};
  world.work_waits = true;
  simulation.run(world, 100);
  World slow = world;
  slow.draw = 37.5;
  double worked = 0, all = 0;
  std::vector<double> looks;
  for (int i = 0; i < 20; ++i) {
    std::vector<Frame> frames = simulation.run(slow, 1);
    std::ranges::copy(simulation.run(world, 10), std::back_inserter(frames));
    for (std::size_t k = 1; k < frames.size(); ++k) {
      looks.push_back(frames[k].wake - frames[k - 1].wake);
      worked += frames[k - 1].worked;
    }
    all += frames.back().swapped - frames.front().swapped;
  }
  EXPECT_LT(quantile(looks, 1), 42) << "the frame after it is not late";
  EXPECT_GE(worked / all, 1.0 / 3);
}

TEST(FramePacing, AfterAStallNothingIsCaughtUp) {
  Simulation simulation(at_rate(50));
  simulation.run({}, 100);
  World stall;
  stall.draw = 1000;
  simulation.run(stall, 1);
  for (const double apart : intervals(simulation.run({}, 50))) EXPECT_GT(apart, 18);
}

TEST(FramePacing, AClockThatStandsStillGoesOnToNewTargets) {
  FramePacing pacing(at_rate(50), RobotTime{5});
  RobotTime last = pacing.target();
  for (int i = 0; i < 100; ++i) {
    pacing.drawn(RobotTime{5});
    pacing.swapped(RobotTime{5}, (i % 2) * 5ms);
    EXPECT_GT(pacing.target(), last);
    EXPECT_GE(pacing.wake(), RobotTime{5});
    last = pacing.target();
  }
}

// Whatever the instants: wake and target are in order, and near enough that no display stands still.
TEST(FramePacing, AnyScheduleIsBorne) {
  std::mt19937 random(3);
  const auto up_to = [&](double limit) { return std::uniform_real_distribution<double>(0, limit)(random); };
  for (int run = 0; run < 30; ++run) {
    Simulation simulation(at_rate(20 + up_to(100)));
    for (int i = 0; i < 40; ++i) {
      World world;
      world.refresh = i % 3 ? 4 + up_to(40) : 0;
      world.draw = up_to(30);
      world.draw_jitter = up_to(20);
      world.sleep_jitter = up_to(10);
      world.display_jitter = up_to(5);
      world.swap = up_to(4);
      world.work_waits = i % 2;
      for (const Frame& frame : simulation.run(world, 20)) ASSERT_LT(frame.swapped - frame.wake, 120);
      const double next = ms(simulation.pacing().target()) - ms(simulation.pacing().wake());
      ASSERT_LT(next, 130);
    }
    EXPECT_LT(quantile(intervals(simulation.run({}, 100)), 0.9), 90);
  }
}

// What compiles programs, or writes a file, between two frames is no reason to begin the next ones earlier.
TEST(FramePacing, WhatHoldsTheThreadUpIsNoDrawingsCost) {
  Simulation simulation({.rate_hz = 25});
  const World world{.draw = 6};
  simulation.run(world, 100);
  const Duration cost = simulation.pacing().figures().cost;
  for (int i = 0; i < 12; ++i) {
    simulation.hold_up(400);
    simulation.run(world, 1);
  }
  EXPECT_EQ(simulation.pacing().figures().cost, cost);
  const auto after = simulation.run(world, 20);
  for (std::size_t i = 1; i < after.size(); ++i) EXPECT_NEAR(after[i].swapped - after[i - 1].swapped, 40, 4);
}

}  // namespace
}  // namespace foresight::frame_pacing_test
