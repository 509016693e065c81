// Hole filling over whole charts in double precision: means up, colours down.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "tests/texture_gpu/reference/atlas_pixels.hpp"

namespace foresight::reference {

/// A chart's pages before filling.
struct FillChart {
  Eigen::Vector2i pages;
  std::vector<int> neighbours;             ///< charts
  std::vector<bool> resident;              ///< of each page
  std::vector<std::array<bool, 4>> holes;  ///< of each page's tiles: a texel on the surface that no camera has seen
  std::vector<bool> changed;               ///< of each page: to be filled anew; others keep what was filled before
  std::vector<Texel> texels;               ///< level 0, row by row over the whole chart (16 pages.x() wide)
};

/// A chart after filling. Colours 0 .. 1 with alpha: level 0 as the code / 31, above the share of
/// seen texels.
struct FilledChart {
  std::array<std::vector<Eigen::Vector4d>, atlas::kLevels> levels;
  std::vector<Eigen::Vector4d> coarse;             ///< of each page; alpha 1: has a colour
  Eigen::Vector4d mean = Eigen::Vector4d::Zero();  ///< alpha 1: of its own texels, 1/2 handed on
};

/// No chart means are left from an earlier generation.
std::vector<FilledChart> fill(const std::vector<FillChart>& charts);

}  // namespace foresight::reference
