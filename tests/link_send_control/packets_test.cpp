#include "link/send_control/packets.hpp"

#include <random>

#include "link/send_control/pair_receiver.hpp"
#include "link/send_control/pair_sender.hpp"

namespace foresight::packets_test {
namespace {

Acknowledgement some_acknowledgement() {
  Acknowledgement out;
  out.newest = 1000;
  out.before.set(0).set(31).set(32).set(255);
  out.arrivals = {{998, std::chrono::microseconds(1'234'560)}, {1000, std::chrono::microseconds(1'240'000)}};
  out.decoded = {7, 9};
  out.undecodable = 8;
  return out;
}

TEST(Packets, ComeBackAsTheyWere) {
  const std::vector<std::uint8_t> data(100, 5);
  const Packet packet = to_packet({.sequence = 3, .pair = 4, .index = 1, .count = 2, .pair_bytes = 1283, .data = data});
  EXPECT_EQ(packet.size(), kPieceHeader + data.size());
  const auto parsed = parse_packet(packet);
  const auto& piece = std::get<Piece>(parsed);
  EXPECT_EQ(piece.sequence, 3U);
  EXPECT_EQ(piece.pair, 4U);
  EXPECT_EQ(piece.index, 1);
  EXPECT_EQ(std::vector<std::uint8_t>(piece.data.begin(), piece.data.end()), data);

  EXPECT_EQ(std::get<Question>(parse_packet(to_packet(Question{77}))).sequence, 77U);

  const Acknowledgement sent = some_acknowledgement();
  const auto back = std::get<Acknowledgement>(parse_packet(to_packet(sent)));
  EXPECT_EQ(back.newest, sent.newest);
  EXPECT_EQ(back.before, sent.before);
  EXPECT_EQ(back.arrivals[0].at, sent.arrivals[0].at);
  EXPECT_EQ(back.arrivals[1].sequence, 1000U);
  EXPECT_EQ(back.decoded, sent.decoded);
  EXPECT_EQ(back.undecodable, 8U);
}

TEST(Packets, RefusePiecesThatDoNotFitTheirPair) {
  const std::vector<std::uint8_t> data(100, 5);
  const auto refused = [&](Piece piece) {
    piece.data = data;
    return std::holds_alternative<std::monostate>(parse_packet(to_packet(piece)));
  };
  EXPECT_FALSE(refused({.pair = 1, .index = 0, .count = 1, .pair_bytes = 100}));
  EXPECT_TRUE(refused({.pair = 0, .index = 0, .count = 1, .pair_bytes = 100}));
  EXPECT_FALSE(refused({.pair = 1, .index = 1, .count = 1, .pair_bytes = 100})) << "a spare piece";
  EXPECT_FALSE(refused({.pair = 1, .index = 254, .count = 1, .pair_bytes = 100}));
  EXPECT_TRUE(refused({.pair = 1, .index = 255, .count = 1, .pair_bytes = 100}));
  EXPECT_TRUE(refused({.pair = 1, .index = 2, .count = 2, .pair_bytes = kPieceBytes + 100}));
  EXPECT_TRUE(refused({.pair = 1, .index = 0, .count = 2, .pair_bytes = 100}));
  EXPECT_TRUE(refused({.pair = 1, .index = 0, .count = 1, .pair_bytes = 101}));
  EXPECT_TRUE(refused({.pair = 1, .index = 0, .count = 1, .pair_bytes = 0}));
  EXPECT_TRUE(refused({.pair = 1, .index = 9, .count = 65535, .pair_bytes = 0xffffffff}));
}

// Cut, flipped and random ones; both ends go on as if nothing had been.
TEST(Packets, AnyBytesAreTakenWithoutHarm) {
  std::mt19937 random(11);
  const std::vector<std::uint8_t> data(kPieceBytes, 5);
  const std::vector<Packet> right = {
      to_packet({.sequence = 3, .pair = 4, .index = 1, .count = 3, .pair_bytes = 3000, .data = data}),
      to_packet({.sequence = 4, .pair = 4, .index = 5, .count = 3, .pair_bytes = 3000, .data = data}),
      to_packet(Question{5}), to_packet(some_acknowledgement())};
  PairReceiver receiver(make_pair_decoder());
  PairSender sender;
  const auto encoder = make_pair_encoder(Coding::jpeg);
  for (int i = 0; i < 30'000; ++i) {
    Packet packet = right[random() % right.size()];
    for (std::uint32_t k = random() % 6; k > 0; --k)
      packet[random() % packet.size()] = static_cast<std::uint8_t>(random());
    if (random() % 2) packet.resize(random() % (packet.size() + 1));
    const RobotTime now{i * 1000};
    EXPECT_TRUE(receiver.take(packet, now).empty());
    const Packet answer = receiver.acknowledge(now);
    EXPECT_LE(answer.size(), kLargestPacket);
    sender.take(packet, now, *encoder);
    EXPECT_TRUE(sender.packets(now, *encoder).empty());
  }
  EXPECT_TRUE(sender.wants_pair(RobotTime{100'000'000}));
}

}  // namespace
}  // namespace foresight::packets_test
