#include "link/send_control/transmissions.hpp"

namespace foresight::transmissions_test {
namespace {

using std::chrono::milliseconds;

RobotTime at_ms(int ms) {
  return RobotTime{} + milliseconds(ms);
}

Acknowledgement of(std::uint32_t newest, std::initializer_list<std::uint32_t> others, int ms) {
  Acknowledgement out;
  out.newest = newest;
  for (const std::uint32_t other : others) out.before.set(newest - 1 - other);
  out.arrivals = {{newest, milliseconds(ms)}};
  return out;
}

TEST(Transmissions, CountsWhatIsOnItsWayAndWhatCameLately) {
  Transmissions sent;
  for (int i = 0; i < 4; ++i) sent.send(1, static_cast<std::uint16_t>(i), 1000, at_ms(0));
  EXPECT_EQ(sent.unacknowledged(), 4000U);
  EXPECT_EQ(sent.acknowledge(of(2, {1}, 20), at_ms(40)).size(), 2U);
  EXPECT_EQ(sent.acknowledge(of(2, {1}, 20), at_ms(41)).size(), 0U) << "a copy";
  EXPECT_EQ(sent.unacknowledged(), 2000U);
  EXPECT_EQ(sent.acknowledged_within(milliseconds(200), at_ms(240)), 2000U);
  EXPECT_EQ(sent.acknowledged_within(milliseconds(200), at_ms(241)), 0U);
  EXPECT_EQ(sent.round_trip(), milliseconds(40));
}

// 1,000 bytes every 20 ms over a road of 400 ms and back: 20,000 are on it, and no more than 10,000 are acknowledged in
// 200 ms.
TEST(Transmissions, OnALongRoadLooksFartherBack) {
  Transmissions sent;
  EXPECT_EQ(sent.of_late(), milliseconds(200));
  std::uint32_t told = 0;
  for (int ms = 0; ms <= 2000; ms += 20) {
    const std::uint32_t sequence = sent.send(1, 0, 1000, at_ms(ms));
    if (ms >= 400) sent.acknowledge(of(++told, {}, ms - 200), at_ms(ms));
    EXPECT_EQ(sequence, static_cast<std::uint32_t>(ms / 20 + 1));
  }
  EXPECT_EQ(sent.unacknowledged(), 20'000U);
  EXPECT_LE(sent.acknowledged_within(milliseconds(200), at_ms(2000)), 11'000U);
  EXPECT_EQ(sent.of_late(), milliseconds(600));
  EXPECT_GT(sent.acknowledged_within(sent.of_late(), at_ms(2000)), 29'000U);
}

// Ten times a second eight packets that leave together, and come so.
TEST(Transmissions, ALongerRoadIsKnownAfterSomeSeconds) {
  Transmissions sent;
  for (int tenth = 0; tenth < 80; ++tenth) {
    const int begin = 100 * tenth, way = tenth < 30 ? 20 : 170;
    for (int i = 0; i < 8; ++i) sent.send(1, static_cast<std::uint16_t>(i), 1000, at_ms(begin));
    for (std::uint32_t i = 1; i <= 8; ++i)
      sent.acknowledge(of(static_cast<std::uint32_t>(8 * tenth) + i, {}, begin + way), at_ms(begin + 2 * way));
    if (tenth == 29) {
      EXPECT_NEAR(to_seconds(*sent.least_round_trip()), 0.04, 0.001);
    }
  }
  EXPECT_NEAR(to_seconds(*sent.least_round_trip()), 0.34, 0.001);
}

TEST(Transmissions, OfASilenceNothingIsKnown) {
  Transmissions sent;
  EXPECT_EQ(sent.known_calm(), milliseconds(0));
  const auto trip = [&sent](int ms, int lasts) {
    sent.acknowledge(of(sent.send(1, 0, 1000, at_ms(ms)), {}, ms), at_ms(ms + lasts));
  };
  trip(0, 40);
  trip(100, 140);
  EXPECT_EQ(sent.known_calm(), milliseconds(0)) << "it waited for 100 ms";
  trip(300, 40);
  EXPECT_EQ(sent.known_calm(), milliseconds(100));
  EXPECT_EQ(sent.calm(at_ms(900)), milliseconds(660));
  EXPECT_EQ(sent.known_calm(), milliseconds(100)) << "what is on its way may wait";
}

TEST(Transmissions, APacketIsLostWhenALaterOneCame) {
  Transmissions sent;
  sent.send(1, 0, 1000, at_ms(0));
  sent.send(1, 1, 1000, at_ms(1));
  EXPECT_TRUE(sent.lost(at_ms(200)).empty());
  sent.acknowledge(of(2, {}, 20), at_ms(41));
  EXPECT_TRUE(sent.lost(at_ms(44)).empty()) << "it may be overtaken";
  ASSERT_TRUE(sent.due());
  const auto lost = sent.lost(*sent.due());
  ASSERT_EQ(lost.size(), 1U);
  EXPECT_EQ(lost[0].sequence, 1U);
  EXPECT_EQ(sent.unacknowledged(), 0U);
  EXPECT_TRUE(sent.lost_lately(at_ms(60)));
  EXPECT_FALSE(sent.lost_lately(at_ms(11'000)));
}

TEST(Transmissions, WaitsLongerWhereThePacketWasOnlyOvertaken) {
  Transmissions sent;
  sent.send(1, 0, 1000, at_ms(0));
  sent.send(1, 1, 1000, at_ms(0));
  sent.acknowledge(of(2, {}, 20), at_ms(40));
  EXPECT_EQ(sent.lost(at_ms(45)).size(), 1U);
  EXPECT_EQ(sent.acknowledge(of(2, {1}, 20), at_ms(48)).size(), 1U);
  sent.send(2, 0, 1000, at_ms(100));
  sent.send(2, 1, 1000, at_ms(100));
  sent.acknowledge(of(4, {2, 1}, 120), at_ms(140));
  EXPECT_TRUE(sent.lost(at_ms(146)).empty());
  EXPECT_EQ(sent.lost(at_ms(151)).size(), 1U);
}

TEST(Transmissions, AsksOnWhileALineStandsStill) {
  Transmissions sent;
  sent.send(1, 0, 1000, at_ms(0));
  int questions = 0;
  for (int ms = 1; ms <= 20'000; ++ms)
    if (sent.question_due(at_ms(ms))) {
      sent.send(0, 0, 5, at_ms(ms));
      ++questions;
    }
  EXPECT_GE(questions, 325) << "a row of thirty lost packets ends within two seconds";
  EXPECT_LE(questions, 335) << "and a thin line is not filled: 8 kbit/s with headers";
  EXPECT_TRUE(sent.lost(at_ms(20'000)).empty()) << "nothing tells that it was lost";
  EXPECT_LE(sent.unacknowledged(), 1000U + 335 * 5);
}

TEST(Transmissions, TakesNothingFromAcknowledgementsOfOthers) {
  Transmissions sent;
  sent.send(1, 0, 1000, at_ms(0));
  EXPECT_TRUE(sent.acknowledge(of(900, {}, 5), at_ms(9)).empty());
  EXPECT_EQ(sent.unacknowledged(), 1000U);
}

}  // namespace
}  // namespace foresight::transmissions_test
