#include "link/control/control_words.hpp"
#include "tests/control/small_line.hpp"

namespace foresight::control_desk_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class ControlDeskTest : public SmallLineTest {
 protected:
  void let_go_and_press(SmallSeat& it) {
    it.held = false;
    run(200ms);
    it.held = true;
    run(200ms);
  }
};

TEST_F(ControlDeskTest, FollowsWhoAskedLetGoAndPressed) {
  engage(anna_);
  EXPECT_TRUE(status(anna_).follows);
  EXPECT_EQ(status(anna_).words, "");
  anna_.position = {0.05, 0.02};
  run(100ms);
  EXPECT_DOUBLE_EQ(robot_.set_point[0], 0.05);
  anna_.held = false;
  run(50ms);
  EXPECT_FALSE(robot_.follows);
  EXPECT_EQ(desk_.permit().cause(), RestCause::let_go);
}

TEST_F(ControlDeskTest, NothingMovesBeforeTheSwitchWasSeenOpen) {
  anna_.seat.want_control(true);
  anna_.held = true;
  EXPECT_EQ(moves_in(2s), 0);
  EXPECT_TRUE(status(anna_).must_let_go);
  EXPECT_THAT(status(anna_).cure, HasSubstr("let go"));
  let_go_and_press(anna_);
  EXPECT_TRUE(robot_.follows);
}

TEST_F(ControlDeskTest, StatesThatSayNothingNewMayBeRareAndNewsComesAtOnce) {
  engage(anna_);
  const auto states_in = [&](Duration time) {
    const std::uint64_t before = anna_.seat.state().sequence;
    run(time);
    return anna_.seat.state().sequence - before;
  };
  EXPECT_NEAR(static_cast<double>(states_in(1s)), 50, 3);
  desk_.repeat_states_every(200ms);
  EXPECT_NEAR(static_cast<double>(states_in(1s)), 5, 1);
  EXPECT_TRUE(status(anna_).follows);
  anna_.held = false;
  const RobotTime let_go = now_;
  while (status(anna_).follows && now_ - let_go < 1s) step();
  EXPECT_LE(now_ - let_go, 60ms) << "both ways of the line, and a state's usual time";
}

TEST_F(ControlDeskTest, AnOutageStopsItAndItStaysSo) {
  engage(anna_);
  anna_.up_cut = true;
  const RobotTime cut = now_;
  while (robot_.follows) step();
  EXPECT_LE(now_ - cut, 160ms);
  EXPECT_EQ(desk_.permit().cause(), RestCause::expired);
  run(300ms);
  anna_.up_cut = false;
  EXPECT_EQ(moves_in(3s), 0) << "the switch was held all the time";
  EXPECT_TRUE(status(anna_).must_let_go);
  let_go_and_press(anna_);
  EXPECT_TRUE(robot_.follows);
}

TEST_F(ControlDeskTest, WhatTheLineHeldBackIsNotExecuted) {
  engage(anna_);
  // Tapping all the time, without seeing the robot.
  const auto held_back = [&](Duration time, bool tap) {
    anna_.down_cut = tap;
    std::deque<std::pair<RobotTime, FromOperator>> kept;
    for (const RobotTime end = now_ + time; now_ < end;) {
      anna_.held = !tap || (now_.ns / 100'000'000) % 2 == 0;
      step();
      kept.insert(kept.end(), anna_.up.begin(), anna_.up.end());
      anna_.up.clear();
    }
    anna_.up = kept;
    for (auto& packet : anna_.up) packet.first = now_;
    anna_.down_cut = false;
  };
  for (const bool tap : {false, true}) {
    held_back(1s, tap);
    anna_.held = true;
    EXPECT_EQ(moves_in(1s), 0) << tap;
    EXPECT_GT(dropped(SetPointFault::expired), 50u);
    let_go_and_press(anna_);
    EXPECT_TRUE(robot_.follows);
  }
}

// Pressed while the line was down: nobody had seen that the robot had stopped.
TEST_F(ControlDeskTest, APressThatDidNotKnowOfTheStopMovesNothing) {
  engage(anna_);
  anna_.up_cut = anna_.down_cut = true;
  run(200ms);
  anna_.held = false;
  run(100ms);
  anna_.held = true;
  run(10ms);
  anna_.up_cut = anna_.down_cut = false;
  EXPECT_EQ(moves_in(2s), 0);
  EXPECT_GT(dropped(SetPointFault::no_consent), 0u);
}

TEST_F(ControlDeskTest, WhoNoLongerSeesTheRobotMovesNothing) {
  engage(anna_);
  anna_.down_cut = true;
  run(700ms);
  EXPECT_FALSE(robot_.follows);
  anna_.down_cut = false;
  EXPECT_EQ(moves_in(2s), 0);
}

TEST_F(ControlDeskTest, ASeatAgreesByAPressAndByNothingElse) {
  engage(anna_);
  const Nonce agreed = desk_.permit().consent();
  anna_.up_cut = true;
  run(300ms);
  anna_.up_cut = false;
  sent_.clear();
  run(1s);
  ASSERT_NE(anna_.seat.state().consent, agreed);
  for (const FromOperator& message : sent_) {
    const auto* point = std::get_if<SetPoint>(&message.body);
    ASSERT_TRUE(point == nullptr || point->consent == agreed);
  }
}

TEST_F(ControlDeskTest, BeginsWhereTheRobotStandsOrNotAtAll) {
  anna_.position = {0.5, 0};
  anna_.seat.want_control(true);
  run(1s);
  anna_.held = true;
  EXPECT_EQ(moves_in(300ms), 0);
  EXPECT_THAT(status(anna_).words, HasSubstr("where the robot stands"));
  anna_.position = anna_.seat.begin();
  EXPECT_EQ(moves_in(300ms), 0) << "this press moves nothing any more";
  let_go_and_press(anna_);
  EXPECT_TRUE(robot_.follows);
}

TEST_F(ControlDeskTest, ARobotThatStoppedByItselfWaitsForAnotherPress) {
  engage(anna_);
  for (int i = 0; i < 30; ++i) {
    step();
    robot_.follows = false;  // as of a safety gate that has latched
    robot_.ready = false;
  }
  EXPECT_EQ(desk_.permit().cause(), RestCause::robot_stopped);
  EXPECT_EQ(moves_in(1s), 0);
}

TEST_F(ControlDeskTest, APauseOfTheRobotsProgramStops) {
  engage(anna_);
  const Nonce consent = desk_.permit().consent();
  now_ = now_ + 150ms;
  step();
  EXPECT_EQ(desk_.permit().cause(), RestCause::paused) << "whatever has not expired yet";
  EXPECT_NE(desk_.permit().consent(), consent);
  EXPECT_EQ(moves_in(2s), 0);
  let_go_and_press(anna_);
  EXPECT_TRUE(robot_.follows);
}

// Its clock has not moved, so that what had come before looks as if it had just been sent.
TEST_F(ControlDeskTest, ASuspendedRobotsHostStops) {
  engage(anna_);
  const Nonce consent = desk_.permit().consent();
  ASSERT_FALSE(anna_.up.empty());
  anna_.ahead += 5s;
  desk_.stood_still();
  EXPECT_EQ(desk_.permit().cause(), RestCause::paused);
  EXPECT_NE(desk_.permit().consent(), consent);
  EXPECT_EQ(moves_in(3s), 0);
  EXPECT_GT(dropped(SetPointFault::clock_unknown), 0u) << "until the next round trip";
  let_go_and_press(anna_);
  EXPECT_TRUE(robot_.follows);
}

TEST_F(ControlDeskTest, ASuspendedOperatorsHostStops) {
  engage(anna_);
  anna_.ahead -= 5s;
  anna_.seat.stood_still(5s);
  EXPECT_EQ(moves_in(20ms), 2) << "what was on its way before";
  EXPECT_EQ(moves_in(3s), 0);
  EXPECT_EQ(status(anna_).phase, ControlSeatStatus::Phase::holding) << "it comes back by itself, but does not move";
  let_go_and_press(anna_);
  EXPECT_TRUE(robot_.follows);
}

class SlowLineTest : public SmallLineTest {
 protected:
  SlowLineTest() : SmallLineTest(600ms) {}
  /// Whether it has moved, once the switch was let go of and pressed again.
  bool moves() {
    anna_.seat.want_control(true);
    run(8s);
    anna_.held = true;
    followed_ = 0;
    run(3s);
    return followed_ > 0;
  }
};

TEST_F(SlowLineTest, CarriesNoCommands) {
  EXPECT_FALSE(moves());
}

TEST_F(SlowLineTest, CarriesThemWhereTheRobotsSideAllowsForItsDelay) {
  ControlDeskOptions options = desk_options();
  options.life.allowed_delay = 1300ms;  // the round trip, and a little
  desk_ = ControlDesk(options);
  EXPECT_TRUE(moves());
  anna_.up_cut = true;
  const RobotTime cut = now_;
  while (robot_.follows) step();
  EXPECT_LE(now_ - cut, 600ms + 250ms + 20ms) << "from the last that was sent: its way, and its life besides";
}

TEST_F(SlowLineTest, CarriesRequestsWhereTheRobotsSideAllowsForItsDelay) {
  ControlDeskOptions options = desk_options();
  options.life.allowed_delay = 1300ms;
  desk_ = ControlDesk(options);
  anna_.seat.want_control(true);
  run(8s);
  anna_.seat.request(LineRequest::enable, time_of(anna_));
  run(4s);
  EXPECT_THAT(executed_, testing::ElementsAre(LineRequest::enable));
}

TEST_F(ControlDeskTest, ALeapOfTheOperatorsClockStops) {
  for (const Duration leap : {Duration(1s), Duration(-1s)}) {
    engage(anna_);
    anna_.ahead += leap;
    run(100ms);
    EXPECT_EQ(moves_in(4s), 0);
    EXPECT_EQ(status(anna_).phase, ControlSeatStatus::Phase::holding) << "it comes back by itself, but does not move";
  }
}

TEST_F(ControlDeskTest, AJumpOfAClockVoidsTheConsentThoughNothingWasToFollow) {
  anna_.commands = false;
  anna_.seat.want_control(true);
  run(1s);
  const Nonce consent = desk_.permit().consent();
  anna_.ahead -= 1s;
  run(500ms);
  EXPECT_EQ(desk_.permit().cause(), RestCause::clock_jumped);
  EXPECT_NE(desk_.permit().consent(), consent);
  EXPECT_EQ(desk_.holder_name(), "anna");
}

TEST_F(ControlDeskTest, ARecordingOfAnEarlierDayIsNobody) {
  engage(anna_);
  const std::vector<FromOperator> recorded = sent_;
  seats_.clear();
  followed_ = 0;
  // The robot's program has started anew, and by chance draws other numbers.
  ControlDeskOptions options = desk_options();
  options.draw = counting(77'000'000);
  desk_ = ControlDesk(options);
  for (const FromOperator& message : recorded) {
    desk_.receive(message, now_);
    step();
  }
  EXPECT_EQ(followed_, 0);
  EXPECT_EQ(desk_.holder_name(), "");
  EXPECT_GT(desk_.counts().strangers, 50u);
}

TEST_F(ControlDeskTest, RequestsAreExecutedOnceAndAcknowledged) {
  engage(anna_);
  const auto id = anna_.seat.request(LineRequest::disable, time_of(anna_));
  for (int i = 0; i < 5; ++i) {
    run(100ms);
    for (const FromOperator& message : std::vector(sent_))
      if (std::holds_alternative<Request>(message.body)) desk_.receive(message, now_);
  }
  EXPECT_THAT(executed_, testing::ElementsAre(LineRequest::disable));
  const auto fates = anna_.seat.take_fates();
  ASSERT_EQ(fates.size(), 1u);
  EXPECT_EQ(fates[0].id, id);
  EXPECT_EQ(fates[0].outcome, RequestOutcome::taken);
}

TEST_F(ControlDeskTest, ALostAnswerIsAskedForAgainAndTheRequestIsNot) {
  engage(anna_);
  anna_.down_cut = true;
  anna_.seat.request(LineRequest::reset, time_of(anna_));
  run(300ms);
  anna_.down_cut = false;
  run(300ms);
  EXPECT_THAT(executed_, testing::ElementsAre(LineRequest::reset));
  EXPECT_EQ(anna_.seat.take_fates().at(0).outcome, RequestOutcome::taken);
}

TEST_F(ControlDeskTest, ARequestFromBeforeALossIsNotExecuted) {
  engage(anna_);
  anna_.up_cut = true;
  anna_.seat.request(LineRequest::home, time_of(anna_));
  run(500ms);
  anna_.up_cut = false;
  run(1s);
  EXPECT_TRUE(executed_.empty());
  EXPECT_EQ(anna_.seat.take_fates().at(0).outcome, RequestOutcome::before_stop);
  anna_.up_cut = true;
  anna_.seat.request(LineRequest::home, time_of(anna_));
  run(1500ms);
  anna_.up_cut = false;
  run(1s);
  EXPECT_TRUE(executed_.empty()) << "nor is one that comes too late";
}

TEST_F(ControlDeskTest, ARequestThatComesTooLateIsNotExecuted) {
  anna_.commands = false;  // so that no set-point is lost
  anna_.seat.want_control(true);
  run(1s);
  anna_.up_cut = true;
  anna_.seat.request(LineRequest::home, time_of(anna_));
  run(1500ms);
  anna_.up_cut = false;
  run(1s);
  EXPECT_TRUE(executed_.empty());
  EXPECT_EQ(anna_.seat.take_fates().at(0).outcome, RequestOutcome::expired);
}

TEST_F(ControlDeskTest, EverybodyMayStop) {
  seats_.push_back(&ben_);
  engage(anna_);
  ben_.seat.request(LineRequest::enable, time_of(ben_));
  ben_.seat.request(LineRequest::emergency_stop, time_of(ben_));
  run(500ms);
  EXPECT_THAT(executed_, testing::ElementsAre(LineRequest::emergency_stop));
  const auto fates = ben_.seat.take_fates();
  ASSERT_EQ(fates.size(), 2u);
  EXPECT_EQ(fates[0].outcome, RequestOutcome::not_holder);
}

TEST_F(ControlDeskTest, WhatDiffersIsNamedAndRefusedWhereItMatters) {
  Identity other = sample_identity("carl");
  other.calibration = 44;
  other.program = "1.1";
  other.scene = 55;  // the robot looks at none
  SmallSeat harmless(other, 200'000);
  other.urdf = 12;
  other.joints[1] = "elbow";
  SmallSeat wrong(other, 300'000);
  other = sample_identity("newer");
  other.protocol = kLineProtocol + 1;
  SmallSeat newer(other, 400'000);
  seats_ = {&wrong, &newer};
  for (SmallSeat* seat : seats_) seat->seat.want_control(true);
  run(1s);
  EXPECT_EQ(desk_.holder_name(), "");
  EXPECT_THAT(status(wrong).words,
              testing::AllOf(HasSubstr("another URDF"), HasSubstr("joint 2 is 'wrist' on the robot, 'elbow' in"),
                             testing::Not(HasSubstr("calibration"))));
  EXPECT_EQ(status(wrong).differences.size(), 4u);
  EXPECT_THAT(status(newer).words, HasSubstr("update the robot's program"));
  wrong.seat.want_control(false);
  run(500ms);
  EXPECT_THAT(status(wrong).words, HasSubstr("another URDF")) << "else he would be told to ask for control";
  EXPECT_EQ(status(wrong).cure, "");
  seats_ = {&harmless};
  engage(harmless);
  EXPECT_EQ(status(harmless).differences.size(), 2u);
}

// Its own differences are in words that this version may misread.
TEST_F(ControlDeskTest, TheSeatItselfRefusesARobotOfAnotherVersion) {
  Identity newer = sample_identity("the robot");
  newer.protocol = kLineProtocol + 1;
  anna_.seat.advance(time_of(anna_));
  anna_.seat.receive({77, anna_.seat.session(), Welcome{88, newer, {}}}, time_of(anna_));
  EXPECT_THAT(status(anna_).words, HasSubstr("update the operator's program"));
  EXPECT_EQ(status(anna_).phase, ControlSeatStatus::Phase::connecting);
  anna_.seat.take_outgoing();
  anna_.seat.want_control(true);
  anna_.seat.advance(time_of(anna_));
  EXPECT_TRUE(anna_.seat.take_outgoing().empty()) << "it would be misread";
  now_ = now_ + 5s;
  EXPECT_EQ(status(anna_).words, "looking for the robot") << "that one is gone";
}

TEST_F(ControlDeskTest, WhatIsNoSetPointMovesNothing) {
  engage(anna_);
  const FromOperator last = sent_.back();
  const auto sample = [&](auto change) {
    FromOperator out = last;
    SetPoint& point = std::get<SetPoint>(out.body);
    point.sequence += 1000;
    point.given = time_of(anna_);
    change(point);
    return out;
  };
  const auto faults = dropped(SetPointFault::malformed);
  desk_.receive(sample([](SetPoint& p) { p.position[1] = std::numeric_limits<double>::quiet_NaN(); }), now_);
  desk_.receive(sample([](SetPoint& p) { p.joints = 99; }), now_);
  desk_.receive(sample([](SetPoint& p) { p.joints = 1; }), now_);
  EXPECT_EQ(dropped(SetPointFault::malformed), faults + 3);
  const auto strangers = dropped(SetPointFault::no_lease);
  desk_.receive(sample([](SetPoint& p) { p.lease += 1; }), now_);
  EXPECT_EQ(dropped(SetPointFault::no_lease), strangers + 1) << "of an earlier lease";
  desk_.receive(sample([](SetPoint& p) { p.given = {INT64_MAX}; }), now_);
  EXPECT_EQ(dropped(SetPointFault::clock_unknown), 1u);
  desk_.receive(sample([](SetPoint& p) {
                  p.sequence += 1;
                  p.given = p.given - 10s;
                  p.lasts = Duration::max();
                }),
                now_);
  EXPECT_GT(dropped(SetPointFault::expired), 0u) << "the robot says how long set-points last";
  const Nonce consent = desk_.permit().consent();
  desk_.receive(sample([](SetPoint& p) {
                  p.sequence += 2;
                  p.given = p.given + 1s;
                }),
                now_);
  EXPECT_EQ(dropped(SetPointFault::from_the_future), 1u);
  EXPECT_NE(desk_.permit().consent(), consent);
}

TEST(SetPointLifeTest, GrowsWithWhatTheLineNeedsAndNoFurther) {
  const auto life_of = [](auto age) {
    SetPointLife life;
    for (int i = 0; i < 600; ++i) life.came(age(i), {1'000'000'000 + i * 20'000'000LL});
    return life.life();
  };
  EXPECT_EQ(life_of([](int) { return 1ms; }), 100ms);
  EXPECT_EQ(life_of([](int) { return 60ms; }), 140ms);
  EXPECT_EQ(life_of([](int) { return 2s; }), 250ms) << "a line that is slower than this carries no commands";
  const Duration rough = life_of([](int i) { return Duration((30 + i % 100) * 1ms); });
  EXPECT_GT(rough, 200ms);
  EXPECT_LE(rough, 350ms);
  EXPECT_EQ(life_of([](int i) { return Duration((i % 2) * 9s); }), 500ms) << "whatever the line does";
}

}  // namespace
}  // namespace foresight::control_desk_test
