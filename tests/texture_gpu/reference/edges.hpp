// Uncertain edges by brute force: every pixel at which a surface ends, every neighbour within the margin.
#pragma once

#include <vector>

#include "tests/texture_gpu/reference/ray_caster.hpp"

namespace foresight::reference {

enum class Answer { no, yes, borderline };

/// For every pixel p of a face: is there, within margin + 1/2 px, a pixel q at which a surface ends,
/// towards the side of p (that along which p is farther), and does p lie behind that surface by more than the tolerance
/// (metres)? Or is p itself such a q for others, on a surface that does not also end within four pixels towards the
/// side opposite to one at which it ends at p?
///
/// A surface ends at q where q lies in front of the plane of the two pixels next to it (in some row
/// or column), by more than the tolerance; where only one pixel follows, in front of that one as far
/// as q's own slope does not explain it. It is thought to go on from q towards each side as it is seen
/// there, or where it ends (within two pixels it bends by more than the tolerance) as the plane of the
/// other side, but no closer than q. Curved surfaces and those of one or two pixels just keep q's depth. Beyond the
/// picture nothing is known. Borderline where rounding to float decides.
std::vector<Answer> uncertain_edges(const FacePicture& face, double margin_px, double depth_tolerance);

/// Least and largest 1/z over each 4x4 block of pixels with model, and whether it has any without.
struct Block {
  double least = 1e30, largest = 0;
  bool has_hole = false;
};
std::vector<Block> depth_blocks(const FacePicture& face);

}  // namespace foresight::reference
