// Whatever comes: nothing moves, nothing breaks. Sanitizers look on where they are built in.
#include <random>

#include "tests/control/small_line.hpp"

namespace foresight::any_message_test {
namespace {

using namespace std::chrono_literals;

class AnyMessageTest : public SmallLineTest {
 protected:
  std::uint64_t any() {
    // Small, large, and those that are known.
    const std::uint64_t n = random_();
    switch (n % 4) {
      case 0: return random_() >> (n % 60);
      case 1: return n % 8;
      case 2: return known_[n / 4 % known_.size()];
      default: return ~std::uint64_t{0} - n % 3;
    }
  }
  std::int64_t signed_any() { return static_cast<std::int64_t>(any()); }
  double number() {
    const std::array values{0.0, -1.0, 0.05, 1e300, std::numeric_limits<double>::infinity(), std::nan("")};
    return values[random_() % values.size()];
  }
  LinePositions positions() {
    LinePositions out;
    for (double& p : out) p = random_() % 3 == 0 ? number() : 0.01;
    return out;
  }
  Identity identity() {
    Identity out = sample_identity(std::string(any() % 300, static_cast<char>(any())));
    if (any() % 2 == 0) out.joints.assign(any() % 40, "\n\x1b[2J");
    out.protocol = static_cast<std::uint32_t>(any());
    return out;
  }
  FromOperator from_operator() {
    FromOperator out{any(), any(), ClockPing{any()}};
    switch (random_() % 8) {
      case 0: out.body = Hello{identity()}; break;
      case 1: out.body = ClockPong{any(), signed_any(), signed_any()}; break;
      case 2: out.body = Ask{any()}; break;
      case 3: out.body = GiveBack{any()}; break;
      case 4: out.body = HandOver{any(), any()}; break;
      case 5:
        out.body =
            SetPoint{any(), any(), any(), {signed_any()}, Duration(signed_any()), any() % 2 == 0, any(), positions()};
        break;
      case 6:
        out.body =
            Request{any(), static_cast<LineRequest>(any()), any(), any(), {signed_any()}, Duration(signed_any())};
        break;
      default: break;
    }
    return out;
  }
  FromRobot from_robot() {
    FromRobot out{any(), any(), ClockPing{any()}};
    switch (random_() % 6) {
      case 0: out.body = Welcome{any(), identity(), {{"words", "cure", true}}}; break;
      case 1: out.body = ClockPong{any(), signed_any(), signed_any()}; break;
      case 2: out.body = LeaseVerdict{any(), any(), "words"}; break;
      case 3: out.body = Answer{any(), static_cast<RequestOutcome>(any() % 5)}; break;
      case 4: {
        ControlState state;
        state.sequence = any();
        state.time = {signed_any()};
        state.holder = any();
        state.consent = any();
        state.joints = any();
        state.begin = positions();
        out.body = state;
        break;
      }
      default: break;
    }
    return out;
  }
  void learn() {
    known_ = {1,
              2,
              3,
              1'000'000,
              1'000'001,
              1'000'002,
              1'000'003,
              desk_.permit().lease(),
              desk_.permit().consent(),
              static_cast<std::uint64_t>(now_.ns),
              static_cast<std::uint64_t>(time_of(anna_).ns)};
  }

  std::mt19937_64 random_{1};
  std::vector<std::uint64_t> known_{1};
};

TEST_F(AnyMessageTest, TheDeskBearsIt) {
  engage(anna_);
  anna_.held = false;
  run(100ms);
  seats_.clear();  // anna has gone; others have seen all of her numbers
  run(200ms);
  for (int i = 0; i < 40'000; ++i) {
    learn();
    desk_.receive(from_operator(), now_);
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
    anna_.seat.receive(from_robot(), time_of(anna_));
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
