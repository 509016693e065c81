// Which level each node of a view is to have.
//
//   by size, by acuity    each for itself: the coarsest one that nobody can tell from the mesh
//   reactive              likewise, but what may be told grows while frames take too long, and shrinks while they do
//   not predictive            all together: the most benefit for what the frame may cost
#pragma once

#include <span>
#include <vector>

namespace foresight {

/// What choosing has to know of a node that is seen.
struct LevelCandidate {
  std::span<const double> errors;          ///< m, of its levels, ascending from 0
  std::span<const std::size_t> triangles;  ///< of them, descending
  double px_per_m = 0;                     ///< of its surface in the view; infinite: the finest level
  double area_px = 0;                      ///< that its box covers
  double acuity = 1;                       ///< in (0, 1]: how much of that the eye sees (acuity.hpp)
  double importance = 1;
  int last = -1;  ///< its level in the frame before; -1: none
};

/// The coarsest level whose error is at most `px` / acuity pixels. Where `hysteresis` is above 0, the last one stays as
/// long as its error is within that share beyond, and the next coarser one's is not as far below.
int coarsest_within(const LevelCandidate& node, double px, double hysteresis);

/// The feedback that "reactive" selection works by. One thread.
class ReactiveTolerance {
 public:
  /// `px`: allowed while there is time; at least that, at most 64 times that.
  explicit ReactiveTolerance(double px) : least_(px), px_(px) {}
  double px() const { return px_; }
  /// The last frame took so long. Nothing changes by numbers that are none.
  void took(double ms, double budget_ms);

 private:
  double least_, px_;
};

struct BudgetRule {
  double ms_per_triangle = 0;
  double ms_per_node = 0;
  double budget_ms = 0;       ///< of all nodes
  double px = 1;              ///< an error of this size halves a level's benefit
  double invisible_px = 0.1;  ///< errors below nobody sees: time is not spent on them
  double hysteresis = 0.1;    ///< benefit lost by a level that is not the last one
};

/// Levels of the largest benefit within the budget, or as near to it as a greedy search comes (the problem is a
/// knapsack's): starting from the last frame's levels, the node that loses least for its cost becomes coarser while
/// they cost too much, then the one that gains most becomes finer while that fits. Beyond the budget only where all
/// nodes have their coarsest level.
///   benefit = area x importance x acuity x accuracy(level) x hysteresis(level, last)
/// (Funkhouser and Sequin, "Adaptive Display Algorithm for Interactive Frame Rates During Visualization of Complex
/// Virtual Environments", SIGGRAPH 1993.)
std::vector<int> levels_within_budget(std::span<const LevelCandidate> nodes, const BudgetRule& rule);

}  // namespace foresight
