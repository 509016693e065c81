// Rooms, and the openings through which one is seen from another: what of a building can be seen at all.
//
//   .-------.-------.      cells hold nodes that do not move, walls included; what moves, and what stands in no cell,
//   is | hall  p  lab  |      not hidden by them |   *   p       |      portals are convex, and lie in the openings
//   '-------'-------'
//
// (Cells and portals: Jones 1971; at run time: Luebke and Georges, "Portals and Mirrors", 1995.)
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

namespace foresight {

struct Cell {
  std::string name;
  Eigen::AlignedBox3d box;  ///< world, m
  std::vector<int> nodes;   ///< of the scene, wholly inside
};

/// A convex polygon between two cells.
struct Portal {
  std::array<int, 2> cells{};
  std::vector<Eigen::Vector3d> corners;  ///< world, m, in order around it, either way
};

/// Immutable.
class CellGraph {
 public:
  static constexpr double kTolerance = 0.02;  ///< m: a portal may lie off its cells, and off a plane, by so much

  /// Throws std::invalid_argument, with words for people: no cell; two of one name; an empty box; a node in two cells;
  /// a cell without a portal (where there are several); a portal of less than three corners, that is not flat and
  /// convex, between a cell and itself or none, or away from one of its cells.
  CellGraph(std::vector<Cell> cells, std::vector<Portal> portals);

  const std::vector<Cell>& cells() const { return cells_; }
  const std::vector<Portal>& portals() const { return portals_; }
  /// Indices of its portals.
  const std::vector<int>& portals_of(int cell) const { return portals_of_[static_cast<std::size_t>(cell)]; }
  /// Those that hold the point: none outside of the building, two at a border.
  std::vector<int> cells_at(const Eigen::Vector3d& p_world) const;

 private:
  std::vector<Cell> cells_;
  std::vector<Portal> portals_;
  std::vector<std::vector<int>> portals_of_;
};

}  // namespace foresight
