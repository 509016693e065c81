// The levels of all nodes of a scene.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "scene/lod/mesh_levels.hpp"
#include "scene/visibility.hpp"

namespace foresight {

/// Immutable.
class SceneLevels {
 public:
  /// `part_of`: a part of each triangle of the scene, node after node, or empty (make_mesh_levels). Takes some 3 s of
  /// CPU time for a million triangles, on all cores. Throws std::invalid_argument: another count of parts than of
  /// triangles.
  explicit SceneLevels(const SceneModel& scene, std::span<const int> part_of = {},
                       const MeshLevelOptions& options = {});

  /// One for each node; without levels where it has no triangle.
  const std::vector<MeshLevels>& nodes() const { return nodes_; }
  /// Of that node, as selection reads them: errors (m) and triangles of its levels, finest first.
  std::span<const double> errors(std::size_t node) const { return errors_[node]; }
  std::span<const std::size_t> triangles(std::size_t node) const { return triangles_[node]; }
  const NodeBoxes& boxes() const { return boxes_; }

  /// A sentence for each node that is worth levels and has none: which, and why.
  std::vector<std::string> remarks() const;

 private:
  std::vector<std::string> names_;
  std::vector<MeshLevels> nodes_;
  std::vector<std::vector<double>> errors_;
  std::vector<std::vector<std::size_t>> triangles_;
  NodeBoxes boxes_;
};

}  // namespace foresight
