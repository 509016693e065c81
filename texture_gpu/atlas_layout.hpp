// Where texels live in GPU memory: pages in slots of array textures.
#pragma once

#include <cstdint>

namespace foresight::atlas {

inline constexpr int kPage = 16;  ///< texels along a page's side
inline constexpr int kTile = 8;   ///< texels along the side of a work group; four tiles a page
/// Layers are narrow, so that the rows of a page lie close together in memory: where a renderer
/// keeps textures row by row, a page then touches two or three memory pages instead of sixteen. And low: textures grow
/// by whole layers, of 2.8 MB of colours with their pyramid and 1 MB of heights.
inline constexpr int kLayerWidth = 128, kLayerHeight = 4096;  ///< texels
inline constexpr int kSlotsPerRow = kLayerWidth / kPage;
inline constexpr int kRowsPerLayer = kLayerHeight / kPage;
inline constexpr int kSlotsPerLayer = kSlotsPerRow * kRowsPerLayer;
inline constexpr int kLevels = 5;  ///< 16, 8, 4, 2, 1 texels a side: the hole filling's pyramid
inline constexpr std::uint32_t kNoSlot = 0xffffffffu;

inline constexpr std::uint64_t kTexelBytes = 4;  ///< of a colour (texel.hpp)
/// Bytes of one page's colours with its pyramid: 4/3 of level 0.
inline constexpr std::uint64_t kColourBytes = kTexelBytes * (256 + 64 + 16 + 4 + 1);
/// Bytes of one page's heights.
inline constexpr std::uint64_t kHeightBytes = 2 * 256;

}  // namespace foresight::atlas
