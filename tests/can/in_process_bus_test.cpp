#include "drivers/can/in_process_bus.hpp"

#include <gtest/gtest.h>

#include "tests/can/frames.hpp"

namespace foresight::in_process_bus_test {
namespace {

using namespace std::chrono_literals;

TEST(InProcessBus, DeliversToAllOthersInOrder) {
  MonotonicClock clock;
  InProcessBus bus("can0", clock);
  const auto a = bus.attach(), b = bus.attach(), c = bus.attach();
  EXPECT_EQ(a->send(frame(0x123, {1, 2})), CanSend::sent);
  EXPECT_EQ(b->send(frame(0x124)), CanSend::sent);
  const auto first = c->receive(0ms), second = c->receive(0ms);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->id, 0x123u);
  EXPECT_EQ(first->payload().size(), 2u);
  EXPECT_EQ(second->id, 0x124u);
  EXPECT_EQ(a->receive(0ms)->id, 0x124u) << "not its own";
  EXPECT_FALSE(a->receive(0ms));
}

TEST(InProcessBus, RefusesWhatIsNoFrame) {
  MonotonicClock clock;
  InProcessBus bus("can0", clock);
  const auto a = bus.attach();
  EXPECT_EQ(a->send(frame(0x800)), CanSend::invalid);
  CanFrame long_one = frame(1);
  long_one.size = 9;
  EXPECT_EQ(a->send(long_one), CanSend::invalid);
}

TEST(InProcessBus, WaitingMovesASteppedClockToTheAnswer) {
  SteppedClock clock;
  InProcessBus bus("can0", clock);
  const auto master = bus.attach(), node = bus.attach();
  clock.every(1ms, [&](RobotTime) {
    if (node->receive(0ms)) node->send(frame(0x581));
  });
  master->send(frame(0x601));
  const auto answer = master->receive(50ms);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->time.ns, 1'000'000);
  EXPECT_FALSE(master->receive(50ms));
  EXPECT_EQ(clock.now().ns, 51'000'000);
}

}  // namespace
}  // namespace foresight::in_process_bus_test
