// What crosses the line: pairs in pieces, and what the receiver tells about them. Little endian.
//
//   piece            'p', sequence, pair, index, count, bytes of the pair, data
//   question         'q', sequence: answered like a piece; asks whether the line still carries anything
//   acknowledgement  'a', newest sequence, which of those before it came, when the last ones came, pairs decoded
//
// Each transmission has a sequence of its own, also that of a piece that is sent again.
#pragma once

#include <bitset>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "common/time.hpp"

namespace foresight {

using Packet = std::vector<std::uint8_t>;

inline constexpr std::size_t kLargestPacket =
    1200;  ///< bytes; fits every path of today without fragments (RFC 9000, 14)

struct Piece {
  std::uint32_t sequence = 0;
  std::uint32_t pair = 0;
  std::uint16_t index = 0, count = 0;  ///< of the pair's own pieces; from index `count` on they are spare ones
  std::uint32_t pair_bytes = 0;
  /// Bytes index * kPieceBytes on, kPieceBytes of them but for the last one; or a spare piece (erasure_code.hpp).
  std::span<const std::uint8_t> data{};

  bool is_spare() const { return index >= count; }
};
inline constexpr std::size_t kPieceHeader = 17;
inline constexpr std::size_t kPieceBytes = kLargestPacket - kPieceHeader;

struct Question {
  std::uint32_t sequence = 0;
};

struct Acknowledgement {
  struct Arrival {
    std::uint32_t sequence = 0;
    Duration at{};  ///< on the receiver's clock, whose epoch is its own; in steps of 10 us
  };
  static constexpr std::size_t kBefore = 256, kMostArrivals = 64, kMostDecoded = 16;

  std::uint32_t newest = 0;
  std::bitset<kBefore> before;         ///< bit i: newest - 1 - i came
  std::vector<Arrival> arrivals;       ///< the last ones, at least one, oldest first, within 10 min
  std::vector<std::uint32_t> decoded;  ///< the last pairs
  std::uint32_t undecodable = 0;       ///< the last pair that came whole and builds on what is not here; 0: none
};

Packet to_packet(const Piece& piece);
Packet to_packet(const Question& question);
Packet to_packet(const Acknowledgement& acknowledgement);

/// What `bytes`, which may be anything, say; nothing where they are none of these, whole and within their bounds. The
/// data of a piece stays where it is.
std::variant<std::monostate, Piece, Question, Acknowledgement> parse_packet(std::span<const std::uint8_t> bytes);

}  // namespace foresight
