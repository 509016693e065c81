// Who of several operators commands, and for how many there is room.
#include "tests/control/small_line.hpp"

namespace foresight::several_operators_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

using SeveralOperatorsTest = SmallLineTest;

TEST_F(SeveralOperatorsTest, ASecondOperatorIsRefusedAndToldWhoCommands) {
  seats_.push_back(&ben_);
  engage(anna_);
  ben_.seat.want_control(true);
  ben_.held = false;
  run(1s);
  EXPECT_THAT(status(ben_).words, HasSubstr("'anna' commands"));
  EXPECT_TRUE(status(ben_).wanted);
  EXPECT_EQ(status(ben_).cure, "") << "the words say what to do";
  ben_.held = true;
  run(1s);
  EXPECT_EQ(desk_.holder_name(), "anna");
  EXPECT_EQ(desk_.asking_name(now_), "ben");
  EXPECT_EQ(dropped(SetPointFault::no_lease), 0u) << "a seat without the lease sends no set-points";
  EXPECT_TRUE(robot_.follows);
}

TEST_F(SeveralOperatorsTest, HandingOverNeedsBothOrSomebodyBesideTheRobot) {
  seats_.push_back(&ben_);
  engage(anna_);
  EXPECT_FALSE(anna_.seat.hand_over()) << "nobody asks";
  ben_.seat.want_control(true);
  run(500ms);
  EXPECT_TRUE(anna_.seat.hand_over());
  run(500ms);
  EXPECT_EQ(desk_.holder_name(), "ben");
  EXPECT_FALSE(robot_.follows) << "neither the old one nor the new one drives";
  EXPECT_EQ(status(anna_).phase, ControlSeatStatus::Phase::connected);
  ben_.held = true;
  run(300ms);
  EXPECT_TRUE(robot_.follows);
  anna_.seat.want_control(true);
  run(500ms);
  EXPECT_EQ(desk_.holder_name(), "ben");
  EXPECT_TRUE(desk_.consent_to_asking(now_));
  EXPECT_EQ(desk_.holder_name(), "anna");
  EXPECT_EQ(moves_in(1s), 0);
}

TEST_F(SeveralOperatorsTest, WhoIsNotHeardLosesTheLease) {
  seats_.push_back(&ben_);
  engage(anna_);
  ben_.seat.want_control(true);
  seats_ = {&ben_};  // anna's program is gone
  run(4s);
  EXPECT_EQ(desk_.holder_name(), "ben");
}

TEST_F(SeveralOperatorsTest, WhatWasGivenBackStaysSoWhateverComesLate) {
  engage(anna_);
  const std::vector<FromOperator> recorded = sent_;
  anna_.seat.want_control(false);
  run(500ms);
  EXPECT_EQ(desk_.holder_name(), "");
  for (const FromOperator& message : recorded) desk_.receive(message, now_);
  EXPECT_EQ(desk_.holder_name(), "") << "an Ask that comes late";
  EXPECT_EQ(moves_in(500ms), 0);
}

/// How many of `messages` give back.
std::ptrdiff_t returns_in(const std::vector<FromOperator>& messages) {
  return std::ranges::count_if(
      messages, [](const FromOperator& message) { return std::holds_alternative<GiveBack>(message.body); });
}

TEST_F(SeveralOperatorsTest, GivesBackOnceHoweverOftenItIsToldThatNothingIsWanted) {
  engage(anna_);
  for (int i = 0; i < 50; ++i) {
    anna_.seat.want_control(false);
    run(10ms);
  }
  EXPECT_EQ(returns_in(sent_), 1);
  EXPECT_EQ(desk_.holder_name(), "");
}

TEST_F(SeveralOperatorsTest, ARequestThatIsWithdrawnIsNotHandedOver) {
  seats_.push_back(&ben_);
  engage(anna_);
  ben_.seat.want_control(true);
  run(500ms);
  ben_.seat.want_control(false);
  ben_.seat.take_outgoing();  // is lost
  run(1s);
  EXPECT_FALSE(desk_.consent_to_asking(now_));
  EXPECT_EQ(desk_.holder_name(), "anna");
}

TEST_F(SeveralOperatorsTest, RoomForAFewOperatorsIsNotTakenByMany) {
  engage(anna_);
  for (Nonce stranger = 9'000; stranger < 9'100; ++stranger)
    desk_.receive({stranger, 0, Hello{sample_identity(std::string(100'000, 'x'))}}, now_);
  EXPECT_EQ(desk_.peers().size(), DeskPeers::kMost);
  EXPECT_LT(desk_.peers().back().identity.name.size(), 100u);
  run(6s);
  EXPECT_EQ(desk_.peers().size(), 1u);
  EXPECT_TRUE(robot_.follows);
}

/// Says Hello, and then some word: that it was greeted is known to it.
class ManyOperatorsTest : public SeveralOperatorsTest {
 protected:
  void hello(Nonce theirs) { desk_.receive({theirs, 0, Hello{sample_identity("somebody")}}, now_); }
  void come_and_go(Nonce theirs) {
    hello(theirs);
    if (const DeskPeer* peer = known(theirs)) desk_.receive({theirs, peer->ours, ClockPing{1}}, now_);
  }
  const DeskPeer* known(Nonce theirs) {
    for (const DeskPeer& peer : desk_.peers())
      if (peer.theirs == theirs) return &peer;
    return nullptr;
  }
};

TEST_F(ManyOperatorsTest, WhoIsSilentMakesRoomForWhoComes) {
  engage(anna_);
  for (Nonce gone = 9'000; gone < 9'000 + DeskPeers::kMost - 1; ++gone) {
    come_and_go(gone);
    step();
  }
  ASSERT_EQ(desk_.peers().size(), DeskPeers::kMost);
  seats_.push_back(&ben_);
  step();
  ben_.seat.request(LineRequest::emergency_stop, time_of(ben_));
  run(150ms);
  EXPECT_EQ(status(ben_).phase, ControlSeatStatus::Phase::connected);
  EXPECT_THAT(executed_, testing::ElementsAre(LineRequest::emergency_stop));
  EXPECT_EQ(known(9'000), nullptr) << "the one who was not heard for longest";
  EXPECT_NE(known(9'001), nullptr);
  EXPECT_TRUE(robot_.follows);
}

TEST_F(ManyOperatorsTest, WhoHoldsOrAsksForControlMakesRoomForNobody) {
  seats_.push_back(&ben_);
  engage(anna_);
  ben_.seat.want_control(true);
  run(500ms);
  anna_.up_cut = ben_.up_cut = true;  // longest unheard
  run(500ms);
  for (Nonce other = 9'000; other < 9'020; ++other) {
    come_and_go(other);
    step();
  }
  EXPECT_EQ(desk_.peers().size(), DeskPeers::kMost);
  EXPECT_EQ(desk_.holder_name(), "anna");
  EXPECT_EQ(desk_.asking_name(now_), "ben");
  EXPECT_NE(known(ben_.seat.session()), nullptr);
}

// As of a recording that is played in a loop: nobody is there who hears the Welcome.
TEST_F(ManyOperatorsTest, AHelloThatNobodyFollowsUpTakesNobodysPlace) {
  seats_.push_back(&ben_);
  engage(anna_);
  run(500ms);
  for (Nonce played = 9'000; played < 9'100; ++played) hello(played);
  EXPECT_EQ(desk_.peers().size(), DeskPeers::kMost);
  EXPECT_NE(known(ben_.seat.session()), nullptr);
  const Nonce session = ben_.seat.session();
  run(5s);
  EXPECT_EQ(ben_.seat.session(), session);
  EXPECT_EQ(status(ben_).phase, ControlSeatStatus::Phase::connected);
}

TEST_F(ManyOperatorsTest, OneMoreThanThereIsRoomForCanStopTheRobot) {
  engage(anna_);
  std::deque<SmallSeat> others;
  for (Nonce i = 0; i < DeskPeers::kMost; ++i) seats_.push_back(&others.emplace_back("one more", 300'000 + 1000 * i));
  run(1s);
  for (SmallSeat& other : others) {
    executed_.clear();
    other.seat.request(LineRequest::emergency_stop, time_of(other));
    run(3s);
    EXPECT_THAT(executed_, testing::ElementsAre(LineRequest::emergency_stop));
    other.seat.take_fates();
  }
  EXPECT_TRUE(robot_.follows);
}

}  // namespace
}  // namespace foresight::several_operators_test
