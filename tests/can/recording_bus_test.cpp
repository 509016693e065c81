#include "drivers/can/recording_bus.hpp"

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "drivers/can/in_process_bus.hpp"
#include "drivers/can/replay_log.hpp"
#include "tests/can/frames.hpp"

namespace foresight::recording_bus_test {
namespace {

using namespace std::chrono_literals;

TEST(RecordingBus, LogsBothDirectionsWithTheirTimes) {
  SteppedClock clock;
  InProcessBus medium("can7", clock);
  const auto a = medium.attach(), b = medium.attach();
  const TempFile file;
  {
    RecordingBus recorded(*a, clock, file.path(), Duration{1s});
    clock.sleep_until({5'000'000});
    EXPECT_EQ(recorded.send(frame(0x601, {0x40})), CanSend::sent);
    EXPECT_EQ(recorded.send(frame(0x900)), CanSend::invalid) << "which is not logged";
    clock.sleep_until({7'000'000});
    b->send(frame(0x581, {0x43}));
    ASSERT_TRUE(recorded.receive(0ms));
    EXPECT_EQ(recorded.name(), "can7");
    EXPECT_EQ(recorded.dropped(), 0u);
  }
  EXPECT_EQ(file.read(), "(0000000001.005000) can7 601#40 T\n(0000000001.007000) can7 581#43 R\n");
}

TEST(RecordingBus, CountsWhatItDropsAndPassesItOn) {
  MonotonicClock clock;
  InProcessBus medium("can0", clock);
  const auto a = medium.attach(), b = medium.attach(100000);
  const TempFile file;
  constexpr int kFrames = 20000;
  std::uint64_t dropped = 0;
  {
    RecordingBus recorded(*a, clock, file.path(), Duration{0}, 16);
    for (int i = 0; i < kFrames; ++i) ASSERT_EQ(recorded.send(frame(1)), CanSend::sent);
    dropped = recorded.dropped();
  }
  EXPECT_GT(dropped, 0u);
  int logged = 0, arrived = 0;
  CandumpReader reader(file.path());
  while (reader.next()) ++logged;
  while (b->receive(0ms)) ++arrived;
  EXPECT_EQ(logged + static_cast<int>(dropped), kFrames);
  EXPECT_EQ(arrived, kFrames);
}

TEST(RecordingBus, AFullDiskDoesNotStopTheBus) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  MonotonicClock clock;
  InProcessBus medium("can0", clock);
  const auto a = medium.attach();
  RecordingBus recorded(*a, clock, "/dev/full");
  const RobotTime give_up = clock.now() + 5s;
  while (!recorded.failed() && clock.now() < give_up) ASSERT_EQ(recorded.send(frame(1)), CanSend::sent);
  EXPECT_TRUE(recorded.failed());
}

TEST(ReplayLog, KeepsTheLogsPace) {
  const TempFile file(
      "(100.000000) can0 101#\n(100.010000) can0 102#\n(100.010000) can0 20000040#0000000000000000\ncan0 103#\n"
      "(100.030000) can0 104#\n");
  SteppedClock clock;
  InProcessBus medium("can0", clock);
  const auto a = medium.attach(), b = medium.attach();
  ReplayLogOptions options;
  options.speed = 2;
  CandumpReader reader(file.path());
  const ReplayLogSummary summary = replay_log(reader, *a, clock, options);
  EXPECT_EQ(summary.sent, 4u);
  EXPECT_EQ(summary.error_frames, 1u);
  EXPECT_EQ(summary.failed, 0u);
  EXPECT_EQ(summary.worst_delay.count(), 0);
  const std::int64_t expected[] = {0, 5'000'000, 5'500'000, 15'500'000};
  for (const std::int64_t at : expected) {
    const auto f = b->receive(0ms);
    ASSERT_TRUE(f);
    EXPECT_EQ(f->time.ns, at);
  }
}

TEST(ReplayLog, StopsWhenAskedAndCountsFailures) {
  const TempFile file("can0 101#\ncan0 102#\ncan0 103#\n");
  SteppedClock clock;
  InProcessBus medium("can0", clock, {});
  const auto a = medium.attach();
  int asked = 0;
  CandumpReader first(file.path());
  EXPECT_EQ(replay_log(first, *a, clock, {}, [&] { return ++asked > 2; }).sent, 1u);
  medium.force_bus_off(*a);
  CandumpReader second(file.path());
  ReplayLogOptions options;
  options.gap = 0ms;
  EXPECT_EQ(replay_log(second, *a, clock, options).failed, 3u);
  options.speed = 0;
  EXPECT_THROW(options.validate(), InputError);
}

}  // namespace
}  // namespace foresight::recording_bus_test
