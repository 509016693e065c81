#include "link/line/delay_line.hpp"

#include <algorithm>

#include "link/line/packet_line.hpp"

namespace foresight::delay_line_test {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr RobotTime kBegin{5'000'000'000};

RobotTime at_ms(double ms) {
  return kBegin + seconds(ms * 1e-3);
}

DirectionSpec with_chances(std::vector<std::uint32_t> at) {
  return {.trace = std::make_shared<const Trace>(DeliveryTrace{std::move(at)})};
}

TEST(DelayLine, DelaysWithoutAnythingElse) {
  DelayLine line({.delay = milliseconds(20)}, kBegin, 1);
  EXPECT_EQ(line.send(at_ms(3), 1200), at_ms(23));
  EXPECT_EQ(line.send(at_ms(3), 60'000), at_ms(23));
}

TEST(DelayLine, SharesChancesAsMahimahiDoes) {
  DelayLine line(with_chances({2, 2, 5, 9}), kBegin, 1);
  EXPECT_EQ(line.send(at_ms(0), 700), at_ms(2));  // both in the first chance
  EXPECT_EQ(line.send(at_ms(0), 700), at_ms(2));
  EXPECT_EQ(line.send(at_ms(0), 3000), at_ms(5));  // 100 + 1500 + 1400 bytes of it
  EXPECT_EQ(line.send(at_ms(6), 100), at_ms(9));   // what was left of 5 ms is past
  EXPECT_EQ(line.send(at_ms(9), 1400), at_ms(9));  // in the chance of this very instant
  EXPECT_EQ(line.send(at_ms(9), 1), at_ms(11));    // the trace starts again
  EXPECT_EQ(line.send(at_ms(19), 1), at_ms(20));   // chances in which nobody waited are lost
  EXPECT_EQ(line.send(at_ms(18'000'000), 1), at_ms(18'000'000));
}

TEST(DelayLine, CarriesAtTheRate) {
  DelayLine line({.delay = milliseconds(10), .bytes_per_s = 100'000}, kBegin, 1);
  EXPECT_EQ(line.send(at_ms(0), 1000), at_ms(20));
  EXPECT_EQ(line.send(at_ms(5), 1000), at_ms(30));   // behind the other
  EXPECT_EQ(line.send(at_ms(50), 1000), at_ms(70));  // the line was idle

  const auto rates =
      std::make_shared<const Trace>(RateTrace{{milliseconds(0), milliseconds(10)}, {100'000, 0}, milliseconds(30)});
  DelayLine stepped({.trace = rates}, kBegin, 1);
  EXPECT_EQ(stepped.send(at_ms(5), 1000), at_ms(35));  // 500 by 10 ms, nothing until 30, 500 more
  EXPECT_DOUBLE_EQ(stepped.capacity(at_ms(0), at_ms(45)), 2000);
}

TEST(DelayLine, ReordersAsRecordedAndOnlyThen) {
  const auto recorded = std::make_shared<const Trace>(PacketTrace{
      {milliseconds(0), milliseconds(10)}, {milliseconds(50), milliseconds(5)}, {false, false}, milliseconds(20)});
  DelayLine line({.trace = recorded}, kBegin, 1);
  EXPECT_EQ(line.send(at_ms(0), 100), at_ms(50));
  EXPECT_EQ(line.send(at_ms(10), 100), at_ms(15));
  EXPECT_EQ(line.send(at_ms(40), 100), at_ms(90));  // the recording repeats

  for (const bool reorder : {false, true}) {
    DelayLine jittery({.jitter = milliseconds(50), .reorder = reorder}, kBegin, 3);
    int overtaken = 0;
    RobotTime last{};
    for (int i = 0; i < 500; ++i) {
      const RobotTime sent = at_ms(i), arrival = *jittery.send(sent, 100);
      EXPECT_GE(arrival, sent);
      EXPECT_TRUE(reorder || arrival - sent <= milliseconds(51));
      overtaken += arrival < last;
      last = arrival;
    }
    EXPECT_EQ(overtaken > 0, reorder);
  }
}

TEST(DelayLine, LosesAsOftenAndAsLongAsAsked) {
  for (const double burst : {1.0, 5.0}) {
    DelayLine line({.loss = 0.02, .burst = burst}, kBegin, 4);
    constexpr int kPackets = 200'000;
    int lost = 0, bursts = 0;
    bool before = false;
    for (int i = 0; i < kPackets; ++i) {
      const bool now = !line.send(at_ms(i), 100);
      lost += now;
      bursts += now && !before;
      before = now;
    }
    EXPECT_NEAR(lost, 0.02 * kPackets, 0.002 * kPackets);
    EXPECT_NEAR(1.0 * lost / bursts, burst == 1 ? 1 / 0.98 : burst, 0.05 * burst);
  }
}

TEST(DelayLine, OutagesHoldOrLose) {
  const Outage held{.at = milliseconds(10), .lasts = milliseconds(5), .every = milliseconds(100)};
  DelayLine holding({.outages = {held, {.at = milliseconds(15), .lasts = milliseconds(2)}}}, kBegin, 1);
  EXPECT_EQ(holding.send(at_ms(9), 1), at_ms(9));
  EXPECT_EQ(holding.send(at_ms(12), 1), at_ms(17));  // one outage follows the other
  EXPECT_EQ(holding.send(at_ms(111), 1), at_ms(115));

  Outage losing = held;
  losing.loses = true;
  DelayLine dropping({.outages = {losing}}, kBegin, 1);
  EXPECT_EQ(dropping.send(at_ms(12), 1), std::nullopt);
  EXPECT_EQ(dropping.send(at_ms(15), 1), at_ms(15));

  DirectionSpec chances = with_chances({4, 11, 16});
  chances.outages = {held};
  EXPECT_EQ(DelayLine(chances, kBegin, 1).send(at_ms(5), 1), at_ms(16));
  DirectionSpec rated{.bytes_per_s = 100'000, .outages = {held}};
  EXPECT_EQ(DelayLine(rated, kBegin, 1).send(at_ms(5), 1000), at_ms(20));
}

TEST(DelayLine, NeverCarriesWhereOutagesTakeEveryChance) {
  DirectionSpec spec = with_chances({10});
  spec.outages = {{.at = milliseconds(9), .lasts = milliseconds(2), .every = milliseconds(10)}};
  EXPECT_EQ(DelayLine(spec, kBegin, 1).send(at_ms(0), 1), std::nullopt);
}

TEST(DelayLine, DropsWhatFindsTheQueueFull) {
  DelayLine line({.bytes_per_s = 100'000, .queue_bytes = 2500}, kBegin, 1);
  EXPECT_TRUE(line.send(at_ms(0), 1000));
  EXPECT_TRUE(line.send(at_ms(0), 1000));
  EXPECT_FALSE(line.send(at_ms(5), 1000));
  EXPECT_TRUE(line.send(at_ms(10), 1000));  // the first one has left
}

TEST(DelayLine, TellsAnIdleLinesAnswerWithoutTouchingIt) {
  DirectionSpec spec = with_chances({5, 10});
  spec.delay = milliseconds(20);
  DelayLine line(spec, kBegin, 1);
  EXPECT_EQ(line.send(at_ms(0), 15'000), at_ms(70));
  EXPECT_EQ(line.idle_arrival(at_ms(1), 100), at_ms(25));
  EXPECT_EQ(line.idle_arrival(at_ms(5), 100), at_ms(25));
  EXPECT_EQ(line.send(at_ms(1), 1500), at_ms(75));
}

TEST(DelayLine, RepeatsBitForBit) {
  const DirectionSpec spec{.jitter = milliseconds(30), .reorder = true, .loss = 0.1, .burst = 3, .bytes_per_s = 1e6};
  DelayLine a(spec, kBegin, 9), b(spec, kBegin, 9), other(spec, kBegin, 10);
  int different = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto arrival = a.send(at_ms(i), 500);
    EXPECT_EQ(arrival, b.send(at_ms(i), 500));
    different += arrival != other.send(at_ms(i), 500);
  }
  EXPECT_GT(different, 900);
}

TEST(PacketLine, GivesPacketsOutInTheOrderOfTheirArrival) {
  const auto recorded = std::make_shared<const Trace>(PacketTrace{
      {milliseconds(0), milliseconds(10)}, {milliseconds(50), milliseconds(5)}, {false, false}, milliseconds(20)});
  PacketLine line({.duplicates = 1, .trace = recorded}, kBegin, 1);
  line.send(at_ms(0), std::vector<std::uint8_t>{1});
  line.send(at_ms(10), std::vector<std::uint8_t>{2, 3});
  EXPECT_EQ(line.on_the_way(), 4U);
  EXPECT_EQ(line.next(), at_ms(15));
  EXPECT_EQ(line.receive(at_ms(14)), std::nullopt);
  EXPECT_EQ(line.receive(at_ms(15)), (PacketLine::Packet{2, 3}));
  EXPECT_EQ(line.receive(at_ms(60)), (PacketLine::Packet{2, 3}));
  EXPECT_EQ(line.receive(at_ms(60)), PacketLine::Packet{1});
  EXPECT_EQ(line.receive(at_ms(60)), PacketLine::Packet{1});
  EXPECT_EQ(line.receive(at_ms(60)), std::nullopt);
}

}  // namespace
}  // namespace foresight::delay_line_test
