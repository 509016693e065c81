#include "link/coding/coded_pair.hpp"

#include <zlib.h>

#include "link/coding/byte_order.hpp"

namespace foresight {
namespace {

constexpr std::uint16_t kMark = 0x4650;
constexpr std::uint8_t kColour = 1, kStereo = 2, kHalved = 4;

std::uint32_t checksum(std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, bytes.data(), bytes.size()));
}

bool within_bounds(const CodedPair& pair) {
  return pair.number > 0 && pair.reference < pair.number && pair.lane < kMostLanes &&
         (pair.coding == Coding::jpeg || pair.coding == Coding::h264) && pair.width > 0 && pair.height > 0 &&
         pair.width <= kLargestPictureSide && pair.height <= kLargestPictureSide && !pair.data.empty() &&
         pair.left_bytes <= pair.data.size() && !(pair.halved && pair.coding == Coding::jpeg);
}

}  // namespace

std::vector<std::uint8_t> to_bytes(const CodedPair& pair) {
  std::vector<std::uint8_t> body;
  body.reserve(kCodedPairHeader + pair.notes.size() + pair.data.size());
  put(body, kMark);
  put(body, static_cast<std::uint8_t>(pair.coding));
  put(body, pair.lane);
  put(body, static_cast<std::uint8_t>((pair.colour ? kColour : 0) | (pair.stereo ? kStereo : 0) |
                                      (pair.halved ? kHalved : 0)));
  put(body, std::uint8_t{0});
  put(body, static_cast<std::uint16_t>(pair.width));
  put(body, static_cast<std::uint16_t>(pair.height));
  put(body, static_cast<std::uint16_t>(pair.notes.size()));
  put(body, pair.number);
  put(body, pair.reference);
  put(body, static_cast<std::uint64_t>(pair.captured.ns));
  put(body, pair.left_bytes);
  put(body, static_cast<std::uint32_t>(pair.data.size()));
  body.insert(body.end(), pair.notes.begin(), pair.notes.end());
  body.insert(body.end(), pair.data.begin(), pair.data.end());
  std::vector<std::uint8_t> out;
  out.reserve(body.size() + 4);
  put(out, checksum(body));
  out.insert(out.end(), body.begin(), body.end());
  return out;
}

std::optional<CodedPair> parse_coded_pair(std::span<const std::uint8_t> bytes) {
  ByteReader reader(bytes);
  const auto sum = reader.take<std::uint32_t>();
  if (!reader.good() || bytes.size() < kCodedPairHeader || checksum(reader.rest()) != sum) return std::nullopt;
  CodedPair pair;
  const auto mark = reader.take<std::uint16_t>();
  pair.coding = static_cast<Coding>(reader.take<std::uint8_t>());
  pair.lane = reader.take<std::uint8_t>();
  const auto flags = reader.take<std::uint8_t>();
  pair.colour = (flags & kColour) != 0;
  pair.stereo = (flags & kStereo) != 0;
  pair.halved = (flags & kHalved) != 0;
  reader.take<std::uint8_t>();
  pair.width = reader.take<std::uint16_t>();
  pair.height = reader.take<std::uint16_t>();
  const std::size_t notes = reader.take<std::uint16_t>();
  pair.number = reader.take<std::uint32_t>();
  pair.reference = reader.take<std::uint32_t>();
  pair.captured.ns = static_cast<std::int64_t>(reader.take<std::uint64_t>());
  pair.left_bytes = reader.take<std::uint32_t>();
  const auto size = reader.take<std::uint32_t>();
  const std::span<const std::uint8_t> rest = reader.rest();
  if (!reader.good() || mark != kMark || rest.size() != notes + size || size > kLargestCodedPair) return std::nullopt;
  pair.notes.assign(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(notes));
  pair.data.assign(rest.begin() + static_cast<std::ptrdiff_t>(notes), rest.end());
  if (!within_bounds(pair)) return std::nullopt;
  return pair;
}

}  // namespace foresight
