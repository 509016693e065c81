// An emergency stop over the line, whatever the line and the programs do meanwhile: it comes, once, or is known not to.
#include "tests/control/small_line.hpp"

namespace foresight::line_stop_test {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr LineRequest kStop = LineRequest::emergency_stop;

class LineStopTest : public SmallLineTest {
 protected:
  /// Anna drives, ben looks on.
  void SetUp() override {
    engage(anna_);
    seats_.push_back(&ben_);
    run(1s);
    ASSERT_EQ(status(ben_).phase, ControlSeatStatus::Phase::connected);
    run(200ms);
  }
  std::uint64_t stop(SmallSeat& it) { return it.seat.request(kStop, time_of(it)); }
  static void cut(SmallSeat& it, bool is_cut) { it.up_cut = it.down_cut = is_cut; }
  /// Its program stands still, and what comes meanwhile waits.
  void freeze(SmallSeat& it, Duration time) {
    const auto all = std::exchange(seats_, {});
    for (SmallSeat* seat : all)
      if (seat != &it) seats_.push_back(seat);
    run(time);
    seats_ = all;
  }
  void expect_taken(SmallSeat& it, std::uint64_t id) {
    const auto fates = it.seat.take_fates();
    ASSERT_EQ(fates.size(), 1u);
    EXPECT_EQ(fates[0].id, id);
    EXPECT_EQ(fates[0].what, kStop);
    EXPECT_EQ(fates[0].outcome, RequestOutcome::taken);
  }
};

TEST_F(LineStopTest, PressedBeforeTheRobotWasFoundItComesWithTheFirstAnswer) {
  SmallSeat carl("carl", 200'000);
  seats_.push_back(&carl);
  const std::uint64_t strangers = desk_.counts().strangers;
  step();
  ASSERT_EQ(status(carl).phase, ControlSeatStatus::Phase::connecting);
  const std::uint64_t id = stop(carl);
  run(150ms);
  EXPECT_THAT(executed_, ElementsAre(kStop));
  EXPECT_EQ(desk_.counts().strangers, strangers) << "nothing is addressed to nobody";
  run(2s);
  EXPECT_THAT(executed_, ElementsAre(kStop));
  expect_taken(carl, id);
}

TEST_F(LineStopTest, PressedDuringAnOutageItComesSoonAfterIt) {
  for (const Duration outage : {Duration(500ms), Duration(3s), Duration(8s), Duration(25s)}) {
    for (const Duration pressed : {Duration(100ms), outage - 20ms}) {
      executed_.clear();
      cut(ben_, true);
      run(pressed);
      const std::uint64_t id = stop(ben_);
      run(outage - pressed);
      EXPECT_THAT(executed_, ElementsAre());
      EXPECT_THAT(status(ben_).words, HasSubstr("emergency stop"));
      cut(ben_, false);
      run(400ms);
      EXPECT_THAT(executed_, ElementsAre(kStop)) << to_seconds(outage) << " s, pressed at " << to_seconds(pressed);
      expect_taken(ben_, id);
      run(2s);
      EXPECT_EQ(executed_.size(), 1u);
    }
  }
}

TEST_F(LineStopTest, LostBeforeItsProgramStoodStillItComesAfterwards) {
  ben_.up_cut = true;
  const std::uint64_t id = stop(ben_);
  step();
  ben_.up_cut = false;
  const Nonce session = ben_.seat.session();
  freeze(ben_, 300ms);
  run(200ms);
  EXPECT_NE(ben_.seat.session(), session) << "all has begun anew";
  EXPECT_THAT(executed_, ElementsAre(kStop));
  run(1s);
  expect_taken(ben_, id);
}

// The robot has stopped, and may have been started again since: it is not stopped a second time.
TEST_F(LineStopTest, ExecutedOnceThoughItsAnswerIsLostWithTheConnection) {
  for (const bool pauses : {false, true}) {
    executed_.clear();
    ben_.down_cut = true;
    const std::uint64_t id = stop(ben_);
    run(100ms);
    ASSERT_THAT(executed_, ElementsAre(kStop));
    ben_.up_cut = true;
    run(8s);  // the robot has forgotten him
    if (pauses) freeze(ben_, 300ms);
    cut(ben_, false);
    run(2s);
    EXPECT_THAT(executed_, ElementsAre(kStop)) << pauses;
    expect_taken(ben_, id);
  }
}

TEST_F(LineStopTest, StopsOfTwoPressesAreTwo) {
  cut(ben_, true);
  stop(ben_);
  run(3s);
  cut(ben_, false);
  run(1s);
  stop(ben_);
  run(1s);
  EXPECT_THAT(executed_, ElementsAre(kStop, kStop));
}

TEST_F(LineStopTest, IsGivenUpAfterHalfAMinuteWhichIsToldThen) {
  cut(ben_, true);
  const std::uint64_t id = stop(ben_);
  run(29s);
  EXPECT_TRUE(ben_.seat.take_fates().empty());
  run(2s);
  const auto fates = ben_.seat.take_fates();
  ASSERT_EQ(fates.size(), 1u) << "while nobody is connected, too";
  EXPECT_EQ(fates[0].id, id);
  EXPECT_EQ(fates[0].outcome, std::nullopt);
  cut(ben_, false);
  run(2s);
  EXPECT_THAT(executed_, ElementsAre());
}

// His clock stood still: by it, he has just pressed.
TEST_F(LineStopTest, TheTimeOfASuspensionCounts) {
  for (const Duration asleep : {Duration(5s), Duration(40s)}) {
    executed_.clear();
    ben_.up_cut = true;
    stop(ben_);
    step();
    freeze(ben_, asleep);
    ben_.up_cut = false;
    ben_.ahead -= asleep;
    ben_.seat.stood_still(asleep);
    run(2s);
    const bool late = asleep > 30s;
    EXPECT_EQ(executed_.size(), late ? 0u : 1u);
    const auto fates = ben_.seat.take_fates();
    ASSERT_EQ(fates.size(), 1u);
    EXPECT_EQ(fates[0].outcome.has_value(), !late);
  }
}

TEST_F(LineStopTest, ComesToARobotWhoseProgramHasStartedAnew) {
  cut(ben_, true);
  const std::uint64_t id = stop(ben_);
  run(1s);
  ControlDeskOptions options = desk_options();
  options.draw = counting(77'000'000);
  desk_ = ControlDesk(options);
  cut(ben_, false);
  run(4s);
  EXPECT_THAT(executed_, ElementsAre(kStop));
  expect_taken(ben_, id);
}

// A reset that came before the stop that it was meant to end would leave the robot stopped, and its operator puzzled.
TEST_F(LineStopTest, WhatItsOperatorAsksForNextComesAfterIt) {
  anna_.commands = false;  // so that no set-point is lost
  run(500ms);
  anna_.up_cut = true;
  stop(anna_);
  step();
  anna_.up_cut = false;
  anna_.seat.request(LineRequest::reset, time_of(anna_));
  run(1s);
  EXPECT_THAT(executed_, ElementsAre(kStop, LineRequest::reset));
}

TEST_F(LineStopTest, ItsOperatorDrivesOnlyOnceItWasAnswered) {
  anna_.down_cut = true;
  stop(anna_);
  run(50ms);
  EXPECT_FALSE(robot_.follows) << "his switch counts as open, whatever becomes of the stop";
  run(250ms);
  anna_.held = false;
  run(50ms);
  anna_.held = true;
  followed_ = 0;
  run(50ms);
  anna_.down_cut = false;
  run(1s);
  EXPECT_EQ(followed_, 0) << "pressed before the answer, and held since";
  EXPECT_TRUE(status(anna_).must_let_go);
  anna_.held = false;
  run(200ms);
  anna_.held = true;
  run(200ms);
  EXPECT_TRUE(robot_.follows) << "nothing of the stop is left";
  EXPECT_THAT(executed_, ElementsAre(kStop));
}

TEST_F(LineStopTest, IsNotPushedOutByOtherRequests) {
  cut(ben_, true);
  stop(ben_);
  step();
  for (int i = 0; i < 50; ++i) ben_.seat.request(LineRequest::reset, time_of(ben_));
  cut(ben_, false);
  run(1s);
  EXPECT_THAT(executed_, ElementsAre(kStop));
}

}  // namespace
}  // namespace foresight::line_stop_test
