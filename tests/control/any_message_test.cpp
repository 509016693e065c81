// Whatever comes: nothing moves, nothing breaks. Sanitizers look on where they are built in.
#include "tests/control/any_messages.hpp"

namespace foresight::any_message_test {
namespace {

using namespace std::chrono_literals;

class AnyMessageTest : public SmallLineTest {
 protected:
  void learn() {
    any_.know({1, 2, 3, 1'000'000, 1'000'001, 1'000'002, 1'000'003, desk_.permit().lease(), desk_.permit().consent(),
               static_cast<std::uint64_t>(now_.ns), static_cast<std::uint64_t>(time_of(anna_).ns)});
  }

  AnyMessages any_;
};

TEST_F(AnyMessageTest, TheDeskBearsIt) {
  engage(anna_);
  anna_.held = false;
  run(100ms);
  seats_.clear();  // anna has gone; others have seen all of her numbers
  run(200ms);
  for (int i = 0; i < 40'000; ++i) {
    learn();
    desk_.receive(any_.from_operator(), now_);
    if (i % 20 != 0) continue;
    step();
    ASSERT_LE(desk_.peers().size(), DeskPeers::kMost);
    for (const double p : robot_.set_point) ASSERT_TRUE(std::isfinite(p));
  }
}

TEST_F(AnyMessageTest, TheSeatBearsItAndFindsTheRobotAgain) {
  engage(anna_);
  for (int i = 0; i < 40'000; ++i) {
    learn();
    anna_.seat.receive(any_.from_robot(), time_of(anna_));
    if (i % 20 != 0) continue;
    step();
    status(anna_);
  }
  anna_.held = false;
  anna_.seat.want_control(false);
  run(10s);
  engage(anna_);
}

}  // namespace
}  // namespace foresight::any_message_test
