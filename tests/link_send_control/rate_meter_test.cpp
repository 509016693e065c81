#include "link/send_control/rate_meter.hpp"

#include "link/line/delay_line.hpp"

namespace foresight {
namespace {

TEST(RateMeter, TellsWhatTheLineCarriesThoughItIsGivenLess) {
  // 12 packets every 100 ms over a line that could carry ten times as much.
  DelayLine line({.delay = std::chrono::milliseconds(20), .bytes_per_s = 1'000'000}, {}, 1);
  RateMeter meter;
  EXPECT_FALSE(meter.rate());
  constexpr Duration kOffset = std::chrono::hours(5);  // of the other clock
  for (int i = 0; i < 240; ++i) {
    const RobotTime sent{i / 12 * 100'000'000LL};
    meter.add(sent, *line.send(sent, 1200) - RobotTime{} + kOffset, 1200);
  }
  EXPECT_NEAR(meter.rate().value(), 1'000'000, 20'000);
}

TEST(RateMeter, FollowsALineThatGetsSlower) {
  RateMeter meter;
  meter.add({}, std::chrono::milliseconds(20), 1000);  // the way without waiting
  Duration at = std::chrono::milliseconds(100);
  for (int i = 0; i < 300; ++i) {  // always something waiting
    at += std::chrono::milliseconds(i < 200 ? 1 : 10);
    meter.add(RobotTime{} + at - std::chrono::milliseconds(60), at, 1000);
    if (i == 199) {
      EXPECT_NEAR(meter.rate().value(), 1e6, 2e4);
    }
    if (i == 260) {
      EXPECT_NEAR(meter.rate().value(), 1e5, 1e4);
    }
  }
}

TEST(RateMeter, ForgetsAGapSoon) {
  RateMeter meter;
  meter.add({}, std::chrono::milliseconds(20), 1000);
  Duration at = std::chrono::milliseconds(100);
  for (int i = 0; i < 60; ++i) {
    at += i == 30 ? Duration(std::chrono::seconds(20)) : Duration(std::chrono::milliseconds(10));
    meter.add(RobotTime{} + at - std::chrono::milliseconds(i == 30 ? 20'050 : 60), at, 1000);
  }
  EXPECT_GT(meter.rate().value(), 7e4);
}

}  // namespace
}  // namespace foresight
