// The heights of a chart's texels, compressed: they are needed once, when a page is first seen, and most pages never
// are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace foresight {

/// ChartRaster::raw by its differences from the plane through a texel's neighbours, which are small where a surface is
/// made of triangles, with Zstandard (RFC 8878).
class PackedHeights {
 public:
  PackedHeights() = default;
  /// `raw`: rows of `width`. Throws std::bad_alloc.
  PackedHeights(const std::vector<std::uint16_t>& raw, int width);

  std::vector<std::uint16_t> unpacked() const;
  std::size_t bytes() const { return packed_.size(); }

 private:
  std::vector<std::byte> packed_;
  std::size_t count_ = 0, width_ = 1;
};

}  // namespace foresight
