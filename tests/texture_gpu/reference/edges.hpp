// Uncertain edges by brute force: every pixel, every neighbour within the margin.
#pragma once

#include <vector>

#include "tests/texture_gpu/reference/ray_caster.hpp"

namespace foresight::reference {

enum class Answer { no, yes, borderline };

/// For every pixel of a face: is there, within margin + 1/2 px, a pixel that lies in front of the
/// plane through this one by more than the tolerance (metres)? Beyond the picture nothing is known.
/// The plane's slope in 1/z is that of the side on which the surface bends less. Borderline where
/// rounding to float decides.
std::vector<Answer> uncertain_edges(const FacePicture& face, double margin_px, double depth_tolerance);

/// Least and largest 1/z over each 4x4 block of pixels with model, and whether it has any without.
struct Block {
  double least = 1e30, largest = 0;
  bool has_hole = false;
};
std::vector<Block> depth_blocks(const FacePicture& face);

}  // namespace foresight::reference
