// When a service may still say that it is alive.
#include "apps/robot/service_notify.hpp"

#include <gtest/gtest.h>

#include "drivers/robot/robot.hpp"

namespace foresight::service_notify_test {
namespace {

using namespace std::chrono_literals;

class LifeOfALoop : public testing::Test {
 protected:
  bool alive(RobotTime now) { return life_.goes_on(now, status_); }
  /// As the loop publishes it.
  void cycle(RobotTime now) {
    status_.time = now;
    status_.loop.count(0ms, 4ms);
  }
  RobotStatus status_;
  LoopLife life_;
  RobotTime now_{1'000'000'000};
};

TEST_F(LifeOfALoop, EndsWithItsCycles) {
  for (int i = 0; i < 5; ++i) {
    cycle(now_ = now_ + 1s);
    EXPECT_TRUE(alive(now_));
  }
  EXPECT_FALSE(alive(now_ + 1s));
  status_.time = now_ + 2s;
  EXPECT_FALSE(alive(now_ + 2s)) << "a time alone is no cycle";
  cycle(now_ + 3s);
  EXPECT_TRUE(alive(now_ + 3s));
}

// No cycle goes on while drives are configured, but it is not for ever.
TEST_F(LifeOfALoop, GoesOnWhileDrivesAreSetUp) {
  cycle(now_);
  EXPECT_TRUE(alive(now_));
  status_.phase = RobotPhase::setting_up;
  for (int i = 1; i < 50; ++i) EXPECT_TRUE(alive(now_ + i * 1s)) << i;
  EXPECT_FALSE(alive(now_ + LoopLife::kSetUpWithin + 1s)) << "it hangs";
  status_.phase = RobotPhase::disabled;
  cycle(now_ + 80s);
  EXPECT_TRUE(alive(now_ + 80s));
}

}  // namespace
}  // namespace foresight::service_notify_test
