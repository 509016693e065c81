#include "link/send_control/pair_receiver.hpp"

#include <random>

#include "link/send_control/erasure_code.hpp"
#include "tests/support/model_pair_coder.hpp"

namespace foresight::pair_receiver_test {
namespace {

/// A pair of five pieces and two spare ones, of which any arrive.
class PairReceiverTest : public testing::Test {
 protected:
  PairReceiverTest() {
    CodedPair pair{.number = 1, .coding = Coding::h264, .width = 1, .height = 1};
    pair.data.resize(4 * kPieceBytes + 50);
    std::mt19937 random(4);
    for (std::uint8_t& byte : pair.data) byte = static_cast<std::uint8_t>(random());
    bytes_ = to_bytes(pair);
    spares_ = spare_pieces(bytes_, 2);
  }
  /// Whether the picture is there with it.
  bool arrives(std::uint16_t index) {
    Piece piece{.sequence = ++sequence_, .pair = 1, .index = index, .count = 5};
    piece.pair_bytes = static_cast<std::uint32_t>(bytes_.size());
    const std::span<const std::uint8_t> all(index < 5 ? bytes_ : spares_);
    piece.data = all.subspan((index < 5 ? index : index - 5) * kPieceBytes);
    piece.data = piece.data.first(std::min(kPieceBytes, piece.data.size()));
    return receiver_.take(to_packet(piece), RobotTime{sequence_}).size() == 1;
  }
  Acknowledgement answer() {
    return std::get<Acknowledgement>(parse_packet(receiver_.acknowledge(RobotTime{1'000'000'000})));
  }

  std::vector<std::uint8_t> bytes_, spares_;
  PairReceiver receiver_{std::make_unique<ModelPairDecoder>()};
  std::uint32_t sequence_ = 0;
};

TEST_F(PairReceiverTest, SparePiecesStandInForLostOnes) {
  for (const std::uint16_t index : {0, 2, 5, 4}) EXPECT_FALSE(arrives(index)) << index;
  EXPECT_TRUE(arrives(6)) << "in place of the second and the fourth";
  EXPECT_EQ(answer().decoded, std::vector<std::uint32_t>{1});
}

TEST_F(PairReceiverTest, AreNotWaitedForWhereNothingIsLost) {
  for (const std::uint16_t index : {6, 0, 1, 2}) EXPECT_FALSE(arrives(index)) << index;
  EXPECT_TRUE(arrives(3)) << "with the spare one there are five";
  EXPECT_FALSE(arrives(4));
  EXPECT_FALSE(arrives(5));
}

TEST_F(PairReceiverTest, TheSameSparePieceCountsOnce) {
  for (const std::uint16_t index : {0, 2, 4, 5, 5}) EXPECT_FALSE(arrives(index)) << index;
  EXPECT_TRUE(arrives(1));
}

TEST_F(PairReceiverTest, AWrongSparePieceShowsNothing) {
  spares_[10] ^= 1;
  for (const std::uint16_t index : {0, 1, 2, 4, 5}) EXPECT_FALSE(arrives(index)) << index;
  EXPECT_EQ(answer().undecodable, 1U) << "what it made does not fit the checksum";
}

}  // namespace
}  // namespace foresight::pair_receiver_test
