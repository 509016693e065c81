// Numbers as USB writes them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace foresight::usb {

using Bytes = std::vector<std::uint8_t>;

/// Overwrites `size` bytes at `at`, the lowest first. The bytes are there already.
inline void put(Bytes& bytes, std::size_t at, std::uint32_t value, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) bytes.at(at + i) = static_cast<std::uint8_t>(value >> 8 * i);
}
inline void append(Bytes& bytes, std::uint32_t value, std::size_t size) {
  bytes.resize(bytes.size() + size);
  put(bytes, bytes.size() - size, value, size);
}
/// What is missing counts as 0.
inline std::uint32_t get(std::span<const std::uint8_t> bytes, std::size_t at, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t i = size; i-- > 0;) value = value << 8 | (at + i < bytes.size() ? bytes[at + i] : 0u);
  return value;
}

}  // namespace foresight::usb
