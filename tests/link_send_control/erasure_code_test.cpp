#include "link/send_control/erasure_code.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "link/send_control/packets.hpp"

namespace foresight::erasure_code_test {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(ErasureCode, AnyAsManyPiecesAsThereAreOwnOnesAreEnough) {
  std::mt19937 random(7);
  for (const std::size_t size :
       {std::size_t{1}, std::size_t{700}, kPieceBytes, kPieceBytes + 1, 20 * kPieceBytes + 7, 160 * kPieceBytes}) {
    Bytes pair(size);
    std::generate(pair.begin(), pair.end(), [&] { return static_cast<std::uint8_t>(random()); });
    const auto own = static_cast<std::uint16_t>((size + kPieceBytes - 1) / kPieceBytes);
    const std::size_t others = std::min<std::size_t>(own + 1, kMostCodedPieces - own), bytes = spare_piece_bytes(size);
    const Bytes spares = spare_pieces(pair, others);
    ASSERT_EQ(spares.size(), others * bytes);
    for (int round = 0; round < 20; ++round) {
      std::vector<std::uint16_t> came(own + others);
      std::iota(came.begin(), came.end(), std::uint16_t{0});
      std::shuffle(came.begin(), came.end(), random);
      came.resize(own);
      Bytes here(size, 0);
      std::vector<std::uint16_t> missing;
      std::map<std::uint16_t, Bytes> spare;
      for (std::uint16_t i = 0; i < own; ++i) {
        const std::size_t begin = i * kPieceBytes, end = std::min(size, begin + kPieceBytes);
        if (std::find(came.begin(), came.end(), i) == came.end()) {
          missing.push_back(i);
        } else {
          std::copy(pair.data() + begin, pair.data() + end, here.data() + begin);
        }
      }
      for (const std::uint16_t i : came)
        if (i >= own)
          spare[i] = {spares.data() + (i - own) * bytes, spares.data() + (i - own + std::size_t{1}) * bytes};
      restore_pieces(here, missing, spare);
      ASSERT_EQ(here, pair) << size << " bytes, " << missing.size() << " pieces missing";
    }
  }
}

TEST(ErasureCode, SaysWhereItIsAskedForMoreThanThereIs) {
  Bytes pair(3 * kPieceBytes);
  EXPECT_THROW(spare_pieces(pair, kMostCodedPieces - 2), std::invalid_argument);
  EXPECT_NO_THROW(spare_pieces(pair, kMostCodedPieces - 3));
  const std::vector<std::uint16_t> missing{0, 1};
  EXPECT_THROW(restore_pieces(pair, missing, {{3, Bytes(kPieceBytes)}}), std::invalid_argument);
}

}  // namespace
}  // namespace foresight::erasure_code_test
