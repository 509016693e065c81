#include "scene/cells.hpp"

#include <set>
#include <stdexcept>

namespace foresight {
namespace {

Eigen::Vector3d normal_of(const std::vector<Eigen::Vector3d>& corners) {
  Eigen::Vector3d out = Eigen::Vector3d::Zero();  // Newell: of polygons whose first corners are in line, too
  for (std::size_t i = 0; i < corners.size(); ++i) out += corners[i].cross(corners[(i + 1) % corners.size()]);
  return out;
}

bool flat_and_convex(const std::vector<Eigen::Vector3d>& corners) {
  const Eigen::Vector3d area = normal_of(corners);
  if (area.norm() < 1e-6) return false;
  const Eigen::Vector3d normal = area.normalized();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d &a = corners[i], &b = corners[(i + 1) % corners.size()],
                          &c = corners[(i + 2) % corners.size()];
    if (std::abs(normal.dot(a - corners[0])) > CellGraph::kTolerance) return false;
    if ((b - a).cross(c - b).dot(normal) < -1e-9) return false;
  }
  return true;
}

}  // namespace

CellGraph::CellGraph(std::vector<Cell> cells, std::vector<Portal> portals)
    : cells_(std::move(cells)), portals_(std::move(portals)), portals_of_(cells_.size()) {
  if (cells_.empty()) throw std::invalid_argument("there are portals, but no cells");
  std::set<std::string> names;
  std::set<int> nodes;
  for (const Cell& cell : cells_) {
    const std::string name = "cell '" + cell.name + "'";
    if (!names.insert(cell.name).second) throw std::invalid_argument("two cells are named '" + cell.name + "'");
    if (cell.box.isEmpty() || cell.box.volume() <= 0) throw std::invalid_argument(name + " has no volume");
    for (const int node : cell.nodes)
      if (!nodes.insert(node).second)
        throw std::invalid_argument("a node of " + name + " is in another cell, too, or twice in it");
  }
  for (std::size_t i = 0; i < portals_.size(); ++i) {
    const Portal& portal = portals_[i];
    const std::string name = "portal " + std::to_string(i + 1);
    if (portal.cells[0] == portal.cells[1]) throw std::invalid_argument(name + " joins a cell with itself");
    if (portal.corners.size() < 3 || !flat_and_convex(portal.corners))
      throw std::invalid_argument(name + " is no flat convex polygon");
    for (const int cell : portal.cells) {
      if (cell < 0 || cell >= static_cast<int>(cells_.size()))
        throw std::invalid_argument(name + " joins no two cells");
      const Cell& of = cells_[static_cast<std::size_t>(cell)];
      for (const Eigen::Vector3d& corner : portal.corners)
        if (of.box.exteriorDistance(corner) > kTolerance)
          throw std::invalid_argument(name + " lies away from cell '" + of.name + "'");
      portals_of_[static_cast<std::size_t>(cell)].push_back(static_cast<int>(i));
    }
  }
  for (std::size_t i = 0; i < cells_.size() && cells_.size() > 1; ++i)
    if (portals_of_[i].empty())
      throw std::invalid_argument("cell '" + cells_[i].name +
                                  "' has no portal: what is in it could never be seen from outside");
}

std::vector<int> CellGraph::cells_at(const Eigen::Vector3d& p_world) const {
  std::vector<int> out;
  for (std::size_t i = 0; i < cells_.size(); ++i)
    if (cells_[i].box.contains(p_world)) out.push_back(static_cast<int>(i));
  return out;
}

}  // namespace foresight
