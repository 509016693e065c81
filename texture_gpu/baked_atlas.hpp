// All textures of a generation in one ordinary picture, for programs that know no pages.
#pragma once

#include <opencv2/core.hpp>

#include "texture_gpu/texture_readback.hpp"

namespace foresight {

/// Each patch of the surface has one rectangle in the picture, so that every triangle lies in one,
/// at the resolution of the patch's sharpest chart:
///
///     +-----------------+
///     | guard           |    guard: the patch continued, so that bilinear filters see no other
///     |  +-----------+  |    patch, on the picture and on its next two mip levels. Rectangles
///     |  | (0,0) .. size|    start at multiples of 4 px: a pixel of level 2 belongs to one patch.
///     |  +-----------+  |
///     +-----------------+
struct BakedAtlas {
  struct Place {
    cv::Rect rectangle;       ///< px, with its guard
    Eigen::Vector2d corner;   ///< px, from the picture's corner to the patch's (u, v) = (0, 0)
    Eigen::Vector2d density;  ///< px per metre
  };

  cv::Mat colours;            ///< CV_8UC3, BGR, holes filled, at the exposure of the newest image
  std::vector<Place> places;  ///< one per patch
  double scale = 1;           ///< 1: full resolution, less: lowered to fit

  /// Where a point of a patch (node frame, metres) lies: 0..1 across the picture, from its top left.
  Eigen::Vector2d texcoord(const SurfacePatches& surface, int patch, const Eigen::Vector3d& p_node) const;
};

/// Never larger than `most` px a side: resolutions are lowered together until everything fits.
/// What no camera ever saw, nor anything beside it, is grey. Any thread. Throws
/// InputError naming --max-atlas where not even the smallest rectangles fit.
BakedAtlas bake_atlas(const TextureReadback& textures, int most);

}  // namespace foresight
