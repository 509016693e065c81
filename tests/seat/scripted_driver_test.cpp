// What a script does at the switch, by what it is shown.
#include "seat/scripted_driver.hpp"

#include <gtest/gtest.h>

namespace foresight::scripted_driver_test {
namespace {

using namespace std::chrono_literals;

class Endless final : public ScriptedMotion {
 public:
  void begin_at(const JointValues& begin) override {
    position = begin;
    ++begun;
  }
  std::optional<JointValues> step(double dt, const PredictedRobot&) override {
    position[0] += dt;
    return position;
  }
  JointValues position{};
  int begun = 0;
};

struct Seated {
  Endless motion;
  ScriptedDriver driver{motion};
  SeatView view;
  SeatWish wish;

  Seated() {
    view.now = OperatorTime{1'000'000'000};
    view.control.phase = ControlSeatStatus::Phase::holding;
    view.robot.ready = true;
  }
  void run(Duration time) {
    for (const OperatorTime end = view.now + time; view.now < end; view.now = view.now + 10ms) {
      wish = driver.tick(view);
      view.engaged = wish.deadman;
      if (wish.deadman) view.robot.begin = wish.position;
    }
  }
};

TEST(ScriptedDriver, LetsGoWhereTheRobotIsSeenNotToFollowAndGoesOnFromThere) {
  Seated seat;
  seat.run(1s);
  ASSERT_TRUE(seat.wish.deadman);
  ASSERT_GT(seat.motion.position[0], 0.3);
  seat.view.shown.reason = FutureReason::astray;
  seat.run(800ms);
  EXPECT_TRUE(seat.wish.deadman) << "contact and drift pass";
  seat.run(300ms);
  EXPECT_FALSE(seat.wish.deadman);
  EXPECT_EQ(seat.driver.state().losses, 1);
  seat.view.robot.begin[0] = 0.1;  // where it stands in truth
  seat.view.shown.reason = FutureReason::none;
  seat.run(500ms);
  EXPECT_TRUE(seat.wish.deadman);
  EXPECT_EQ(seat.motion.begun, 2);
  EXPECT_LT(seat.wish.position[0], 0.5);
  seat.run(5s);
  EXPECT_TRUE(seat.wish.deadman);
  EXPECT_EQ(seat.driver.state().losses, 1);
}

// What cannot be predicted for another reason is followed all the same.
TEST(ScriptedDriver, GoesOnWhereItIsShownAsMeasuredOnly) {
  Seated seat;
  seat.view.shown.reason = FutureReason::unsure;
  seat.run(5s);
  EXPECT_TRUE(seat.wish.deadman);
  EXPECT_EQ(seat.driver.state().losses, 0);
}

}  // namespace
}  // namespace foresight::scripted_driver_test
