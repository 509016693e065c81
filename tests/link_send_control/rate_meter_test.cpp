#include "link/send_control/rate_meter.hpp"

#include "link/line/delay_line.hpp"

namespace foresight::rate_meter_test {
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

TEST(RateMeter, TakesALongerRoadForNoQueue) {
  DelayLine near({.delay = std::chrono::milliseconds(20), .bytes_per_s = 1'000'000}, {}, 1),
      far({.delay = std::chrono::milliseconds(220), .bytes_per_s = 1'000'000}, {}, 1);
  RateMeter meter;
  int told = 0;
  for (int i = 0; i < 12 * 80; ++i) {
    const RobotTime sent{i / 12 * 100'000'000LL};
    told += meter.add(sent, *(i < 240 ? near : far).send(sent, 1200) - RobotTime{}, 1200) ? 1 : 0;
  }
  EXPECT_GE(told, 5) << "each second";
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

/// 100 kB/s for a second, then `slow_ms` between packets for `count` of them.
RateMeter slower(int slow_ms, int count) {
  RateMeter meter;
  meter.add({}, std::chrono::milliseconds(20), 1000);
  Duration at = std::chrono::milliseconds(100);
  for (int i = 0; i < 100 + count; ++i) {
    at += std::chrono::milliseconds(i < 100 ? 10 : slow_ms);
    meter.add(RobotTime{} + at - std::chrono::milliseconds(300), at, 1000);
  }
  return meter;
}

TEST(RateMeter, TrustsTheLastTimeWhereItWasTheSlower) {
  EXPECT_NEAR(slower(10, 0).rate().value(), 1e5, 1e3);
  EXPECT_LT(slower(40, 2).rate().value(), 3e4);
  EXPECT_LT(slower(120, 1).rate().value(), 1e4);
  EXPECT_GT(slower(1, 80).rate().value(), 2e5) << "and the longer time where that was";
}

TEST(RateMeter, CountsWhatIsOverdue) {
  const RateMeter meter = slower(10, 0);
  EXPECT_NEAR(meter.rate(std::chrono::milliseconds(90)).value(), 1000 / 0.1, 1500);
  EXPECT_LT(meter.rate(std::chrono::seconds(3)).value(), 1e4);
}

}  // namespace
}  // namespace foresight::rate_meter_test
