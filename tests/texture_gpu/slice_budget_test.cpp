// Slices of work beside frames: in the rests, never never, and by schedules alone.
#include "texture_gpu/slice_budget.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <random>
#include <thread>

#include "texture_gpu/frame_gate.hpp"

namespace foresight::slice_budget_test {
namespace {

using namespace std::chrono_literals;

struct Outcome {
  double share = 0;        // of the time, that slices got
  double worst_delay = 0;  // ms that a slice kept a frame from beginning
  int slices = 0, beside_frames = 0;
};

/// One processor: a frame of `draw` ms each `interval` ms, slices of `slice` ms in between. `makes_way`: a frame does
/// not begin while a slice has its turn.
Outcome simulate(double interval, double draw, double slice, double seconds, bool makes_way = false) {
  SliceBudget budget;
  const auto at = [](double ms) { return RobotTime{std::llround(1e6 * ms)}; };
  Outcome out;
  double now = 0, due = interval, worked = 0;
  budget.frame_ends(at(0), at(due));
  while (now < 1e3 * seconds) {
    if (now >= due) {  // the frame has the processor
      while (makes_way && budget.has_turn(at(now))) {
        EXPECT_FALSE(budget.wait(at(now), "slice")) << "whose turn it is may run";
        EXPECT_TRUE(budget.has_turn(at(now + 0.5 * slice))) << "while it runs, too";
        budget.ran(at(now), at(now + slice), "slice");
        now += slice;
        worked += slice;
        ++out.slices;
      }
      if (now > due) out.worst_delay = std::max(out.worst_delay, now - due);
      budget.frame_begins(at(now));
      while (!budget.wait(at(now), "slice")) {  // it is so late that it does not wait for the frame's end
        budget.ran(at(now), at(now + slice), "slice");
        now += slice;
        worked += slice;
        ++out.beside_frames;
      }
      now += draw;
      due = std::max(due + interval, now);
      budget.frame_ends(at(now), at(due));
    }
    const auto until = budget.wait(at(now), "slice");
    if (!until) {
      budget.ran(at(now), at(now + slice), "slice");
      now += slice;
      worked += slice;
      ++out.slices;
    } else {
      EXPECT_GT(until->ns, at(now).ns);
      now = std::min(1e-6 * static_cast<double>(until->ns), std::max(due, now));
      if (now < due) now = std::min(now + 1e-3, due);
    }
  }
  out.share = worked / now;
  return out;
}

TEST(SliceBudget, SlicesRunInTheRestsAndDelayNoFrame) {
  const Outcome outcome = simulate(40, 15, 3, 20);
  EXPECT_LE(outcome.worst_delay, 3) << "the first slice's cost is not known";
  EXPECT_EQ(outcome.beside_frames, 0);
  EXPECT_GT(outcome.share, 0.5) << "of the 62 % that the frames leave";
}

// Frames that leave nothing, or less than a slice: it comes to its turn all the same, and they to theirs.
TEST(SliceBudget, NeverStarves) {
  for (const auto& [draw, slice] : {std::pair{40.0, 3.0}, {39.0, 6.0}, {60.0, 3.0}, {38.0, 25.0}}) {
    const Outcome outcome = simulate(40, draw, slice, 30);
    EXPECT_GT(outcome.share, 0.2) << draw << " " << slice;
    EXPECT_LT(outcome.share, 0.45) << draw << " " << slice;
    EXPECT_LE(outcome.worst_delay, slice + 20) << draw << " " << slice;
  }
}

// What a display is to leave after its frame: work had a third of the time by then.
TEST(SliceBudget, TellsTheRestThatIsDue) {
  SliceBudget budget;
  const auto at = [](int ms) { return RobotTime{} + Duration{1'000'000LL * ms}; };
  budget.frame_begins(at(0));
  EXPECT_TRUE(budget.wait(at(0), "slice"));
  EXPECT_NEAR(static_cast<double>(budget.rest_due(at(36)).count()), 18e6, 1) << "of 54 ms";
  budget.frame_ends(at(36), at(54));
  EXPECT_FALSE(budget.wait(at(36), "slice"));
  budget.ran(at(36), at(54), "slice");
  EXPECT_NEAR(static_cast<double>(budget.rest_due(at(54)).count()), 0, 1);
  budget.ran(at(54), at(69), "slice");  // 15 ms that were not due are 30 ms of which none is
  EXPECT_TRUE((budget.frame_begins(at(69)), budget.wait(at(69), "slice")));
  EXPECT_EQ(budget.rest_due(at(98)), 0ms);
  EXPECT_GT(budget.rest_due(at(101)), 0ms);
}

// A headset's frames take all that there is, at 90 Hz: they make way for a third of the time, and none shares the
// processor with a slice, so that each takes as long as without them.
TEST(SliceBudget, FramesThatMakeWayAreFewerAndNoneIsLonger) {
  for (const auto& [draw, slice] : {std::pair{11.0, 3.0}, {13.0, 6.0}, {10.0, 12.0}, {30.0, 3.0}}) {
    const Outcome outcome = simulate(11.1, draw, slice, 30, true);
    EXPECT_EQ(outcome.beside_frames, 0) << draw << " " << slice;
    EXPECT_GT(outcome.share, 0.3) << draw << " " << slice;
    EXPECT_LT(outcome.share, 0.4) << draw << " " << slice;
    EXPECT_LE(outcome.worst_delay, 2 * std::max(slice, draw)) << draw << " " << slice;
  }
  const Outcome idle = simulate(11.1, 5, 3, 30, true);
  EXPECT_LE(idle.worst_delay, 3) << "nobody waits where there is time for all";
}

// A window at 25 Hz and a headset at 50: slices run where neither draws nor is about to.
TEST(SliceBudget, SlicesRunInWhatTwoDisplaysLeave) {
  SliceBudget budget;
  const auto at = [](int ms) { return RobotTime{} + Duration{1'000'000LL * ms}; };
  budget.ran(at(0), at(3), "slice");
  int ran = 0, beside = 0;
  for (int ms = 40; ms < 4000; ++ms) {
    const int of_window = ms % 40, of_headset = (ms + 10) % 20;  // drawn for 12 and 5 ms
    if (of_window == 0) budget.frame_begins(at(ms), FramesOf::window);
    if (of_window == 12) budget.frame_ends(at(ms), at(ms + 28), FramesOf::window);
    if (of_headset == 0) budget.frame_begins(at(ms), FramesOf::headset);
    if (of_headset == 5) budget.frame_ends(at(ms), at(ms + 15), FramesOf::headset);
    if (ms < 80 || budget.wait(at(ms), "slice")) continue;
    budget.ran(at(ms), at(ms + 3), "slice");
    ++ran;
    beside += of_window < 12 || of_window > 37 || of_headset < 5 || of_headset > 17;
  }
  EXPECT_GT(ran, 200);
  EXPECT_EQ(beside, 0);
}

// The first one has compiled shaders on a busy machine: longer than frames are apart, and than is ever put down.
TEST(SliceBudget, ALongSliceComesToItsTurnBetweenShortFrames) {
  SliceBudget budget;
  budget.ran(RobotTime{}, RobotTime{} + 160ms, "slice");
  bool ran = false;
  for (RobotTime frame = RobotTime{} + 200ms; frame < RobotTime{} + 2s && !ran; frame = frame + 20ms) {
    budget.frame_begins(frame);
    budget.frame_ends(frame + 1ms, frame + 20ms);
    ran = !budget.wait(frame + 1ms, "slice");  // whoever waits is woken then
  }
  EXPECT_TRUE(ran);
}

// On a slow machine the first slices of each kind take seconds, as all programs are compiled in them. Those after it do
// not wait for as long again each.
TEST(SliceBudget, WhatWasCompiledOnceIsNotWaitedForAgain) {
  SliceBudget budget;
  RobotTime now{};
  for (const char* kind : {"depth", "shadows", "colours", "layers"}) {
    budget.ran(now, now + 2s, kind);
    now = now + 2s;
  }
  const RobotTime begin = now;
  int ran = 0;
  for (; ran < 40; now = now + 20ms) {
    budget.frame_begins(now);
    budget.frame_ends(now + 10ms, now + 20ms);
    for (const char* kind : {"depth", "shadows", "colours", "layers"}) {
      if (budget.wait(now + 10ms, kind)) break;
      budget.ran(now + 10ms, now + 12ms, kind);
      ++ran;
    }
    ASSERT_LT((now - begin).count(), Duration(3s).count()) << ran << " slices ran";
  }
}

TEST(SliceBudget, WithoutADisplayNothingWaits) {
  SliceBudget budget;
  EXPECT_FALSE(budget.wait(RobotTime{0}, "slice"));
  budget.frame_begins(RobotTime{0});
  const auto until = budget.wait(RobotTime{1'000'000}, "slice");
  ASSERT_TRUE(until) << "a frame is drawn";
  EXPECT_FALSE(budget.wait(*until, "slice")) << "a drawing that hangs holds up nobody";
  budget.frame_ends(*until, *until + 10ms);
  EXPECT_FALSE(budget.wait(*until + 400ms, "slice")) << "nor one that does not begin";
}

TEST(SliceBudget, LearnsWhatAUnitCosts) {
  SliceBudget budget;
  EXPECT_EQ(budget.units_within(3ms, "tiles", 500), 500) << "nothing is known yet";
  for (int i = 0; i < 20; ++i)
    budget.ran(RobotTime{0}, RobotTime{} + (i % 10 == 9 ? 90ms : 2ms), "tiles", 100);  // now and then preempted
  EXPECT_EQ(budget.units_within(3ms, "tiles", 500), 150);
  EXPECT_EQ(budget.units_within(3ms, "tiles", 40), 40);
  EXPECT_EQ(budget.units_within(1ns, "tiles", 40), 1);
  EXPECT_EQ(budget.expected("tiles", 150), 3ms);
  EXPECT_EQ(budget.expected("other", 150), 0ms);
}

// Tiles of 0.1 ms, frames that leave 14 ms: four whole slices and what is left, none of which delays the next frame.
TEST(SliceBudget, ALastSliceIsAsLongAsTheFrameLeaves) {
  SliceBudget budget;
  const auto run = [&](RobotTime now, double tiles) {
    const RobotTime end = now + Duration{std::llround(1e5 * tiles)};
    budget.ran(now, end, "tiles", tiles);
    return end;
  };
  run(RobotTime{}, 10);
  RobotTime begin = RobotTime{} + 1s;
  for (int frame = 0; frame < 20; ++frame, begin = begin + 40ms) {
    budget.frame_begins(begin);
    RobotTime now = begin + 26ms;
    const RobotTime due = begin + 40ms;
    budget.frame_ends(now, due);
    std::vector<double> slices;
    for (;;) {
      const double tiles = budget.units_now(now, 3ms, "tiles", 500);
      if (budget.wait(now, "tiles", tiles)) break;
      slices.push_back(tiles);
      now = run(now, tiles);
      ASSERT_LE(now.ns, due.ns);
    }
    EXPECT_EQ(slices, (std::vector<double>{30, 30, 30, 30, 20}));
    EXPECT_GE(budget.units_now(due - 500us, 3ms, "tiles", 500), 30) << "not so few: that would cost more than it does";
  }
}

// By a clock that runs: whoever works waits while a frame is drawn, and goes on when it ends.
TEST(FrameGate, HoldsTheWorkWhileAFrameIsDrawn) {
  MonotonicClock clock;
  FrameGate gate(clock);
  EXPECT_EQ(gate.rest_due(), 0s) << "there is no work";
  gate.frame_begins();
  std::atomic<bool> passed = false;
  std::jthread worker([&] {
    gate.begin("slice");
    passed = true;
    gate.end();
  });
  while (gate.slices() == 0) std::this_thread::yield();
  const bool early = passed || gate.in_work();
  gate.frame_ends(clock.now() + 1s);
  worker.join();
  EXPECT_FALSE(early);
  EXPECT_TRUE(passed);
}

/// It stands, and goes on as it is told, while others look at it.
class SetClock final : public Clock {
 public:
  RobotTime now() const noexcept override { return {ns_}; }
  void sleep_until(RobotTime time) noexcept override { ns_ = time.ns; }

 private:
  std::atomic<std::int64_t> ns_ = 0;
};

// Who shows frames lets a slice that has come to its turn end first, and waits for no other.
TEST(FrameGate, WhoShowsFramesLetsASliceHaveItsTurn) {
  SetClock clock;
  FrameGate gate(clock);
  gate.begin("slice");
  gate.make_way();  // returns: nobody shows anything yet, it goes on by itself
  clock.sleep_until(clock.now() + 6ms);
  gate.end();  // it is known to take so long
  gate.frame_ends(clock.now() + 1ms, FramesOf::headset);
  std::atomic<bool> ran = false;
  std::jthread worker([&] {
    gate.begin("slice");
    ran = true;
    clock.sleep_until(clock.now() + 6ms);
    gate.end();
  });
  while (gate.slices() < 2) std::this_thread::yield();
  EXPECT_FALSE(gate.in_work());  // answered once the worker has looked at the clock, and waits
  clock.sleep_until(clock.now() + 12ms);
  gate.make_way();  // returns: frames may put it off for three times as long, and the first slice was beyond its share
  EXPECT_FALSE(ran);
  clock.sleep_until(clock.now() + 19ms);
  gate.make_way();
  EXPECT_TRUE(ran) << "the frame waits for it, however long that is";
}

}  // namespace
}  // namespace foresight::slice_budget_test
