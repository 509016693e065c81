// How far apart two links are that only one or two joints move against each other: looked up in a table that is made
// from their meshes.
//
// Covers of links so near to each other overlap where the links themselves do not: a capsule's cap reaches over the
// next joint. The meshes tell them apart, in microseconds a position, which is too long for a control cycle; but the
// answer depends on two numbers alone.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "motion/posed_links.hpp"
#include "motion/triangle_tree.hpp"

namespace foresight {

/// Immutable; any thread.
class NearLinks {
 public:
  /// A joint that moves the links against each other.
  struct Axis {
    int input = -1;               ///< index of the joint in what PosedLinks::pose() takes
    double lower = 0, upper = 0;  ///< rad or m; infinite: it turns without end
    double lever = 0;             ///< no point of the one link moves faster against the other, m per rad or m
  };
  /// `axes`: one or two. Takes a tenth of a second where meshes are detailed and near to each other everywhere.
  NearLinks(PosedLinks posed, const std::vector<Axis>& axes, std::size_t link, const TriangleTree& body,
            std::size_t other, const TriangleTree& other_body, double clearance);

  /// To be kept apart, m: the clearance, or a third of what they are apart in half of all positions, where that is
  /// less.
  double kept() const noexcept { return kept_; }
  /// One's housing is in the other's: nearer than 4 mm in half of all positions within the limits. No table is made,
  /// and kept() is 0.
  bool nested() const noexcept { return table_.empty(); }
  /// By how much they are farther apart than kept(), m. Where they are so, no more than a lower bound. Where they are
  /// not, at the edge the same, and deeper in the least way of the fastest point to that edge, negative: it leads out.
  /// Linear between positions that are at most kept() apart as that point goes, or 400 a joint. Beyond limits as at
  /// them. Not a number where a position is none.
  double margin(std::span<const double> positions) const noexcept;

 private:
  struct Grid {
    int input = -1, nodes = 1;
    double lower = 0, step = 1, way = 0;  // `way`: of the fastest point, for a step
    bool endless = false;
  };
  struct Maker;
  float& at(int i, int k) { return table_[static_cast<std::size_t>(k * grids_[0].nodes + i)]; }
  float at(int i, int k) const { return table_[static_cast<std::size_t>(k * grids_[0].nodes + i)]; }
  void lay(const std::vector<Axis>& axes, double way, int most_nodes);
  void measure_depths();

  std::array<Grid, 2> grids_;
  std::vector<float> table_;
  double kept_ = 0;
};

}  // namespace foresight
