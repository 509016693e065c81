#include "texture_gpu/packed_heights.hpp"

#include <zstd.h>

#include <new>
#include <stdexcept>

namespace foresight {
namespace {

constexpr int kFastest = 1;

/// What a height would be if it lay on the plane through those beside and above it; all modulo 2^16.
std::uint16_t on_plane(const std::vector<std::uint16_t>& raw, std::size_t at, std::size_t width) {
  const bool has_left = at % width > 0, has_above = at >= width;
  const unsigned left = has_left ? raw[at - 1] : 0u, above = has_above ? raw[at - width] : 0u,
                 across = has_left && has_above ? raw[at - width - 1] : 0u;
  return static_cast<std::uint16_t>(left + above - across);
}

}  // namespace

PackedHeights::PackedHeights(const std::vector<std::uint16_t>& raw, int width)
    : count_(raw.size()), width_(static_cast<std::size_t>(width)) {
  std::vector<std::uint16_t> off(count_);
  for (std::size_t i = 0; i < count_; ++i) off[i] = static_cast<std::uint16_t>(raw[i] - on_plane(raw, i, width_));
  const std::size_t bytes = count_ * sizeof(off[0]);
  std::vector<std::byte> packed(ZSTD_compressBound(bytes));
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), off.data(), bytes, kFastest);
  if (ZSTD_isError(size)) throw std::bad_alloc();  // room for the result is there
  packed_.assign(packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(size));
}

std::vector<std::uint16_t> PackedHeights::unpacked() const {
  std::vector<std::uint16_t> raw(count_);
  if (raw.empty()) return raw;
  const std::size_t bytes = count_ * sizeof(raw[0]);
  if (ZSTD_decompress(raw.data(), bytes, packed_.data(), packed_.size()) != bytes)
    throw std::logic_error("heights do not unpack to as many as there were");
  for (std::size_t i = 0; i < count_; ++i) raw[i] = static_cast<std::uint16_t>(raw[i] + on_plane(raw, i, width_));
  return raw;
}

}  // namespace foresight
