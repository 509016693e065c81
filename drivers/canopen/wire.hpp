// Little-endian numbers in CAN frames, and the identifiers of the predefined connection set (CiA 301, 7.3.3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/can/can_frame.hpp"

namespace foresight::canopen {

inline constexpr std::uint32_t kNmtId = 0x000, kSyncId = 0x080, kEmcyId = 0x080, kTimeId = 0x100;
inline constexpr std::uint32_t kTpdo1Id = 0x180, kRpdo1Id = 0x200, kTpdo2Id = 0x280;
inline constexpr std::uint32_t kSdoAnswerId = 0x580, kSdoRequestId = 0x600, kHeartbeatId = 0x700;
inline constexpr int kLargestNode = 127;

/// The first `bytes` (at most 8) of `data` as an unsigned number, low byte first; absent bytes count as 0.
constexpr std::uint64_t load(std::span<const std::uint8_t> data, std::size_t bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes && i < data.size() && i < 8; ++i) value |= std::uint64_t{data[i]} << (8 * i);
  return value;
}

/// Writes the low bytes of `value` over the whole of `data`.
constexpr void store(std::span<std::uint8_t> data, std::uint64_t value) {
  for (std::size_t i = 0; i < data.size(); ++i) data[i] = i < 8 ? static_cast<std::uint8_t>(value >> (8 * i)) : 0;
}

/// The low `bits` (1 .. 64) of `value` as a two's complement number.
constexpr std::int64_t sign_extended(std::uint64_t value, int bits) {
  const int unused = 64 - bits;
  return static_cast<std::int64_t>(value << unused) >> unused;
}

/// A classic data frame with `size` bytes of 0.
constexpr CanFrame data_frame(std::uint32_t id, std::uint8_t size) {
  CanFrame frame;
  frame.id = id;
  frame.size = size;
  return frame;
}

/// CANopen uses classic data frames with 11-bit identifiers only; all others are foreign to it.
constexpr bool is_canopen(const CanFrame& frame) {
  return !frame.extended && !frame.remote && !frame.error && !frame.fd && frame.size <= 8 && frame.id < 0x800;
}

}  // namespace foresight::canopen
