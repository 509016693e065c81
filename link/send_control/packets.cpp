#include "link/send_control/packets.hpp"

#include <algorithm>

#include "link/coding/byte_order.hpp"
#include "link/coding/coded_pair.hpp"
#include "link/send_control/erasure_code.hpp"

namespace foresight {
namespace {

constexpr std::chrono::microseconds kStep{10};

using Parsed = std::variant<std::monostate, Piece, Question, Acknowledgement>;

Parsed parse_piece(ByteReader reader) {
  Piece piece;
  piece.sequence = reader.take<std::uint32_t>();
  piece.pair = reader.take<std::uint32_t>();
  piece.index = reader.take<std::uint16_t>();
  piece.count = reader.take<std::uint16_t>();
  piece.pair_bytes = reader.take<std::uint32_t>();
  piece.data = reader.rest();
  if (!reader.good() || piece.pair == 0 || piece.pair_bytes == 0 || piece.pair_bytes > kLargestCodedPair ||
      piece.count != (piece.pair_bytes + kPieceBytes - 1) / kPieceBytes)
    return {};
  if (piece.is_spare() && piece.index >= kMostCodedPieces) return {};
  const std::size_t size = piece.is_spare() ? spare_piece_bytes(piece.pair_bytes)
                                            : std::min(kPieceBytes, piece.pair_bytes - piece.index * kPieceBytes);
  if (piece.data.size() != size) return {};
  return piece;
}

Parsed parse_acknowledgement(ByteReader reader) {
  Acknowledgement out;
  out.newest = reader.take<std::uint32_t>();
  for (std::size_t i = 0; i < Acknowledgement::kBefore; i += 32) {
    const auto bits = reader.take<std::uint32_t>();
    for (std::size_t k = 0; k < 32; ++k) out.before[i + k] = ((bits >> k) & 1U) != 0;
  }
  out.undecodable = reader.take<std::uint32_t>();
  const Duration last = kStep * reader.take<std::uint32_t>();
  const std::size_t arrivals = reader.take<std::uint8_t>(), decoded = reader.take<std::uint8_t>();
  if (arrivals == 0 || arrivals > Acknowledgement::kMostArrivals || decoded > Acknowledgement::kMostDecoded) return {};
  for (std::size_t i = 0; i < arrivals; ++i) {
    const auto sequence = reader.take<std::uint32_t>();
    out.arrivals.push_back({sequence, last - kStep * reader.take<std::uint32_t>()});
  }
  for (std::size_t i = 0; i < decoded; ++i) out.decoded.push_back(reader.take<std::uint32_t>());
  if (!reader.good() || !reader.rest().empty()) return {};
  return out;
}

}  // namespace

Packet to_packet(const Piece& piece) {
  Packet out;
  out.reserve(kPieceHeader + piece.data.size());
  put(out, std::uint8_t{'p'});
  put(out, piece.sequence);
  put(out, piece.pair);
  put(out, piece.index);
  put(out, piece.count);
  put(out, piece.pair_bytes);
  out.insert(out.end(), piece.data.begin(), piece.data.end());
  return out;
}

Packet to_packet(const Question& question) {
  Packet out;
  put(out, std::uint8_t{'q'});
  put(out, question.sequence);
  return out;
}

Packet to_packet(const Acknowledgement& acknowledgement) {
  Packet out;
  put(out, std::uint8_t{'a'});
  put(out, acknowledgement.newest);
  for (std::size_t i = 0; i < Acknowledgement::kBefore; i += 32) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 32; ++k) bits |= std::uint32_t{acknowledgement.before[i + k]} << k;
    put(out, bits);
  }
  put(out, acknowledgement.undecodable);
  // The receiver's clock counts from anywhere; its lower 32 bits of 10 us, 12 h, are enough for differences.
  const auto steps = [](Duration d) { return static_cast<std::uint32_t>(static_cast<std::uint64_t>(d / kStep)); };
  const std::uint32_t last = steps(acknowledgement.arrivals.back().at);
  put(out, last);
  put(out, static_cast<std::uint8_t>(acknowledgement.arrivals.size()));
  put(out, static_cast<std::uint8_t>(acknowledgement.decoded.size()));
  for (const Acknowledgement::Arrival& arrival : acknowledgement.arrivals) {
    put(out, arrival.sequence);
    put(out, last - steps(arrival.at));
  }
  for (const std::uint32_t pair : acknowledgement.decoded) put(out, pair);
  return out;
}

Parsed parse_packet(std::span<const std::uint8_t> bytes) {
  ByteReader reader(bytes);
  if (bytes.size() > kLargestPacket) return {};
  switch (reader.take<std::uint8_t>()) {
    case 'p': return parse_piece(reader);
    case 'q': {
      const Question question{reader.take<std::uint32_t>()};
      if (!reader.good() || !reader.rest().empty()) return {};
      return question;
    }
    case 'a': return parse_acknowledgement(reader);
    default: return {};
  }
}

}  // namespace foresight
