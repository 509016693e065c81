#include "link/send_control/wire_count.hpp"

namespace foresight::wire_count_test {
namespace {

using std::chrono::milliseconds;

/// 1,000 bytes, of a pair of one piece.
Packet piece(std::uint32_t sequence, std::uint32_t pair) {
  static const std::vector<std::uint8_t> data(1000 - kPieceHeader);
  Piece out{.sequence = sequence, .pair = pair, .count = 1, .pair_bytes = 1000 - kPieceHeader};
  out.data = data;
  return to_packet(out);
}

Packet told(std::uint32_t newest, std::initializer_list<std::uint32_t> others = {}) {
  Acknowledgement out;
  out.newest = newest;
  for (const std::uint32_t other : others) out.before.set(newest - 1 - other);
  out.arrivals = {{newest, milliseconds(1)}};
  return to_packet(out);
}

RobotTime at_ms(int ms) {
  return RobotTime{} + milliseconds(ms);
}

TEST(WireCount, CountsWhatPassed) {
  WireCount wire;
  for (std::uint32_t i = 1; i <= 4; ++i) wire.leaves(piece(i, i));
  wire.leaves(to_packet(Question{5}));
  EXPECT_EQ(wire.unacknowledged(), 4005U);
  wire.comes(told(3, {1}), at_ms(40));
  wire.comes(told(3, {1}), at_ms(41));  // a copy
  EXPECT_EQ(wire.unacknowledged(), 2005U);
  EXPECT_EQ(wire.acknowledged_within(milliseconds(200), at_ms(240)), 2000U);
  EXPECT_EQ(wire.acknowledged_within(milliseconds(200), at_ms(241)), 0U);
}

TEST(WireCount, APieceThatWasSentAgainCountsOnce) {
  WireCount wire;
  wire.leaves(piece(1, 7));
  wire.leaves(piece(2, 7));
  EXPECT_EQ(wire.unacknowledged(), 1000U);
  wire.comes(told(2), at_ms(40));
  EXPECT_EQ(wire.unacknowledged(), 0U);
  wire.comes(told(2, {1}), at_ms(41));  // the first was only late
  EXPECT_EQ(wire.acknowledged_within(milliseconds(200), at_ms(50)), 1000U);
}

TEST(WireCount, ForgetsWhatNoAcknowledgementCanTellAnyMore) {
  WireCount wire;
  wire.leaves(piece(1, 1));
  wire.leaves(piece(258, 258));
  wire.comes(told(258), at_ms(0));
  EXPECT_EQ(wire.unacknowledged(), 0U);
  wire.leaves(piece(259, 259));
  wire.leaves(piece(515, 515));
  wire.comes(told(515), at_ms(0));
  EXPECT_EQ(wire.unacknowledged(), 1000U) << "it could tell of the 256 before it";
}

}  // namespace
}  // namespace foresight::wire_count_test
