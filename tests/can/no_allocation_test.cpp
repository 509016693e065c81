// What runs in control loops must not allocate after construction: counted, by tests/support/allocations.cpp.
#include <gtest/gtest.h>

#include "common/clock.hpp"
#include "drivers/can/in_process_bus.hpp"
#include "drivers/can/recording_bus.hpp"
#include "drivers/can/socket_can_bus.hpp"
#include "tests/can/frames.hpp"
#include "tests/support/allocations.hpp"

namespace foresight::no_allocation_test {
namespace {

using namespace std::chrono_literals;

template <typename Work>
std::size_t allocations_of(Work&& work) {
  const std::size_t before = allocations();
  work();
  return allocations() - before;
}

TEST(NoAllocation, TheCounterCounts) {
  EXPECT_EQ(allocations_of([] { std::vector<int> some(100); }), 1);
}

TEST(NoAllocation, InProcessBusWithEverythingThatCanGoWrong) {
  SteppedClock clock;
  InProcessBusOptions options;
  options.wire.bit_rate = 1'000'000;
  options.in_flight = 64;  // overflows
  options.faults.loss = options.faults.duplicate = options.faults.reorder = options.faults.error_frame = 0.1;
  options.faults.bus_off = 0.01;
  options.faults.delay_max = 5ms;
  options.faults.recovery = 3ms;
  InProcessBus medium("can0", clock, options);
  const auto a = medium.attach(16), b = medium.attach(16);
  std::mt19937 random(1);
  EXPECT_EQ(allocations_of([&] {
              for (int i = 0; i < 5000; ++i) {
                a->send(random_frame(random));
                b->send(random_frame(random));
                if (i % 3 == 0) clock.sleep_until(clock.now() + 100us);
                if (i % 50 == 0)
                  while (b->receive(0ms)) {
                  }
              }
            }),
            0);
  EXPECT_GT(b->counters().received, 100u);
  EXPECT_GT(b->counters().lost, 0u);
}

TEST(NoAllocation, RecordingCodecAndLoad) {
  SteppedClock clock;
  InProcessBus medium("can0", clock);
  const auto a = medium.attach(), b = medium.attach();
  const TempFile file;
  RecordingBus recorded(*a, clock, file.path(), Duration{0});
  CanBusLoad load({1'000'000, 0});
  std::array<char, kLongestFrameText> text;
  std::mt19937 random(2);
  EXPECT_EQ(allocations_of([&] {
              for (int i = 0; i < 1000; ++i) {
                const CanFrame f = random_frame(random);
                recorded.send(f);
                b->send(f);
                recorded.receive(0ms);
                load.add(f, clock.now());
                parse_can_frame({text.data(), write_can_frame(f, text)});
              }
              load.load(clock.now());
            }),
            0);
}

TEST(NoAllocation, SocketCan) {
  const auto interface = has_can_sockets() ? find_can_interface("vcan0") : std::nullopt;
  if (!interface || !interface->up) GTEST_SKIP() << "no vcan0 that is up; see scripts/test-devices";
  SocketCanBus a("vcan0"), b("vcan0");
  EXPECT_EQ(allocations_of([&] {
              for (int i = 0; i < 100; ++i) {
                a.send(frame(1));
                b.receive(1s);
              }
              b.receive(1ms);
            }),
            0);
  EXPECT_EQ(b.counters().received, 100u);
}

}  // namespace
}  // namespace foresight::no_allocation_test
