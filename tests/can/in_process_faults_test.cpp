// Wire time and faults of the in-process bus, in stepped time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/can/error.h>

#include "common/error.hpp"
#include "drivers/can/candump_log.hpp"
#include "drivers/can/in_process_bus.hpp"
#include "tests/can/frames.hpp"

namespace foresight::in_process_faults_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

InProcessBusOptions with(const CanFaults& faults, int bit_rate = 0) {
  InProcessBusOptions out;
  out.faults = faults;
  out.wire = {bit_rate, 0};
  return out;
}

/// Sends `count` numbered frames a millisecond apart and writes down all that the other end sees, with times.
std::vector<std::string> story(const CanFaults& faults, int bit_rate, int count) {
  SteppedClock clock;
  InProcessBus bus("can0", clock, with(faults, bit_rate));
  const auto a = bus.attach(), b = bus.attach();
  std::vector<std::string> out;
  const auto listen = [&](Duration timeout) {
    const RobotTime until = clock.now() + timeout;
    while (const auto f = b->receive(until - clock.now()))
      out.push_back(std::to_string(f->time.ns) + " " + to_text(*f));
    clock.sleep_until(until);
  };
  for (int i = 0; i < count; ++i) {
    if (a->send(frame(0x100, {static_cast<std::uint8_t>(i >> 8), static_cast<std::uint8_t>(i)})) != CanSend::sent)
      out.push_back("not sent " + std::to_string(i));
    listen(1ms);
  }
  listen(1s);
  return out;
}

TEST(InProcessFaults, SameSeedSameStory) {
  CanFaults faults;
  faults.loss = faults.duplicate = faults.reorder = faults.error_frame = 0.1;
  faults.bus_off = 0.01;
  faults.delay_max = 3ms;
  faults.recovery = 20ms;
  for (const int bit_rate : {0, 1'000'000}) {
    const auto once = story(faults, bit_rate, 500);
    EXPECT_EQ(once, story(faults, bit_rate, 500));
    CanFaults other = faults;
    other.seed = 2;
    EXPECT_NE(once, story(other, bit_rate, 500));
  }
}

TEST(InProcessFaults, HappenAsOftenAsAsked) {
  const auto count = [](const CanFaults& faults) { return static_cast<double>(story(faults, 0, 2000).size()); };
  CanFaults none, loss, duplicate, error;
  loss.loss = 0.2;
  duplicate.duplicate = 0.2;
  error.error_frame = 0.2;
  EXPECT_EQ(count(none), 2000);
  // Three standard deviations of 2000 throws: 54.
  EXPECT_NEAR(count(loss), 1600, 54);
  EXPECT_NEAR(count(duplicate), 2400, 54);
  EXPECT_NEAR(count(error), 2400, 54);
}

TEST(InProcessFaults, DelayKeepsTheOrderAndReorderingDoesNot) {
  CanFaults delay;
  delay.delay_min = 2ms;
  delay.delay_max = 6ms;
  SteppedClock clock;
  InProcessBus bus("can0", clock, with(delay));
  const auto a = bus.attach(), b = bus.attach();
  for (std::uint8_t i = 0; i < 100; ++i) a->send(frame(1, {i}));
  for (std::uint8_t i = 0; i < 100; ++i) {
    const auto f = b->receive(1s);
    ASSERT_TRUE(f);
    ASSERT_EQ(f->data[0], i);
    EXPECT_GE(f->time.ns, 2'000'000);
    EXPECT_LE(f->time.ns, 6'000'000);
  }
  CanFaults reorder;
  reorder.reorder = 0.3;
  int backwards = 0, before = -1;
  for (const auto& line : story(reorder, 0, 200)) {
    const int number = std::stoi(line.substr(line.size() - 4), nullptr, 16);
    backwards += number < before;
    before = number;
  }
  EXPECT_GT(backwards, 20);
}

TEST(InProcessFaults, BusOffStopsThatEndOnlyAndEnds) {
  CanFaults faults;
  faults.recovery = 50ms;
  SteppedClock clock;
  InProcessBus bus("can0", clock, with(faults));
  const auto a = bus.attach(), b = bus.attach(), c = bus.attach();
  bus.force_bus_off(*a);
  EXPECT_EQ(a->state(), CanBusState::bus_off);
  EXPECT_EQ(b->state(), CanBusState::active);
  EXPECT_EQ(a->send(frame(1)), CanSend::bus_down);
  EXPECT_EQ(b->send(frame(2)), CanSend::sent);
  EXPECT_EQ(c->receive(0ms)->id, 2u);
  const auto told = a->receive(0ms);
  ASSERT_TRUE(told && told->error);
  EXPECT_EQ(told->id, CAN_ERR_BUSOFF);
  EXPECT_FALSE(a->receive(49ms)) << "hears nothing while bus-off";
  const auto restarted = a->receive(10ms);
  ASSERT_TRUE(restarted && restarted->error);
  EXPECT_EQ(restarted->id, CAN_ERR_RESTARTED);
  EXPECT_EQ(restarted->time.ns, 50'000'000);
  EXPECT_EQ(a->state(), CanBusState::active);
  EXPECT_EQ(a->send(frame(3)), CanSend::sent);
  EXPECT_EQ(c->receive(0ms)->id, 3u);
  EXPECT_EQ(a->counters().restarts, 1u);
  EXPECT_EQ(a->counters().send_failures, 1u);
  EXPECT_EQ(a->counters().error_frames, 2u);
}

TEST(InProcessFaults, WithoutRecoveryBusOffLastsUntilRestart) {
  CanFaults faults;
  faults.recovery = 0ms;
  SteppedClock clock;
  InProcessBus bus("can0", clock, with(faults));
  const auto a = bus.attach();
  bus.force_bus_off(*a);
  a->receive(0ms);
  EXPECT_FALSE(a->receive(10s));
  EXPECT_EQ(a->state(), CanBusState::bus_off);
  bus.restart(*a);
  EXPECT_EQ(a->state(), CanBusState::active);
}

TEST(InProcessWire, FramesTakeTheirTimeAndTheLowestIdentifierWins) {
  SteppedClock clock;
  InProcessBus bus("can0", clock, with({}, 1'000'000));
  const auto a = bus.attach(), b = bus.attach(), c = bus.attach(), d = bus.attach();
  const CanFrame late = frame(0x700, {1}), later = frame(0x050, {2}), first = frame(0x080);
  a->send(late);
  a->send(later);  // behind its own end's 0x700, as in a controller's queue
  b->send(first);
  CanFrame extended;
  extended.extended = true;
  extended.id = 0x080 << 18;  // the same first 11 bits: loses to the 11-bit frame
  d->send(extended);
  Duration at{0};
  for (const CanFrame& expected : {first, extended, late, later}) {
    const auto f = c->receive(1s);
    at += wire_time(can_bits(expected), {1'000'000, 0});
    ASSERT_TRUE(f);
    EXPECT_TRUE(same(*f, expected)) << to_text(*f);
    EXPECT_EQ(f->time.ns, at.count());
  }
  EXPECT_EQ(bus.busy(), at);
}

TEST(InProcessWire, AFullQueueSaysSo) {
  SteppedClock clock;
  InProcessBusOptions options = with({}, 125'000);
  options.transmit_queue = 3;
  InProcessBus bus("can0", clock, options);
  const auto a = bus.attach(), b = bus.attach();
  int sent = 0;
  while (a->send(frame(1)) == CanSend::sent) ++sent;
  EXPECT_EQ(sent, 3);
  EXPECT_EQ(a->send(frame(1)), CanSend::full);
  EXPECT_EQ(a->counters().send_failures, 2u);
  while (b->receive(100ms)) {
  }
  EXPECT_EQ(b->counters().received, 3u);
}

TEST(InProcessWire, RealTimeThreadsSeeFramesAfterTheirWireTime) {
  MonotonicClock clock;
  InProcessBus bus("can0", clock, with({}, 10'000));
  const auto a = bus.attach(), b = bus.attach();
  const RobotTime before = clock.now();
  a->send(frame(0x123, {1, 2, 3}));
  const RobotTime after = clock.now();
  const auto f = b->receive(60s);
  ASSERT_TRUE(f);
  EXPECT_LE(f->time, clock.now());
  // Stamped with the instant at which the wire was through with it, however late this thread has asked.
  const Duration on_wire = wire_time(can_bits(*f), {10'000, 0});
  EXPECT_GE(f->time, before + on_wire);
  EXPECT_LE(f->time, after + on_wire);
}

TEST(CanFaults, ValidateNamesFieldAndValue) {
  SteppedClock clock;
  CanFaults faults;
  faults.loss = 1.5;
  try {
    InProcessBus("can0", clock, with(faults));
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("faults.loss: 1.5"));
  }
  faults = {};
  faults.loss = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(faults.validate(), InputError);
  faults = {};
  faults.delay_min = 2ms;
  EXPECT_THROW(faults.validate(), InputError);
  faults = {};
  faults.error_frame = 1;
  EXPECT_THROW(faults.validate(), InputError);
  InProcessBusOptions options;
  options.wire.bit_rate = -1;
  EXPECT_THROW(options.validate(), InputError);
}

}  // namespace
}  // namespace foresight::in_process_faults_test
