#include "scene/lod/scene_levels.hpp"

#include <algorithm>
#include <stdexcept>

#include "common/parallel.hpp"

namespace foresight {

SceneLevels::SceneLevels(const SceneModel& scene, std::span<const int> part_of, const MeshLevelOptions& options)
    : boxes_(scene) {
  if (!part_of.empty() && part_of.size() != scene.triangle_count())
    throw std::invalid_argument("another count of parts than of triangles");
  const std::size_t count = scene.nodes().size();
  std::vector<std::size_t> first;
  std::size_t triangles = 0;
  for (const Node& node : scene.nodes()) {
    names_.push_back(node.name);
    first.push_back(triangles);
    triangles += node.mesh.triangles.size();
  }
  nodes_.resize(count);
  parallel_for(count, [&](std::size_t n) {
    const Mesh& mesh = scene.nodes()[n].mesh;
    if (mesh.triangles.empty()) return;
    std::vector<int> parts;
    if (!part_of.empty()) {  // those of a node start at 0
      const auto own = part_of.subspan(first[n], mesh.triangles.size());
      const int least = *std::ranges::min_element(own);
      for (const int part : own) parts.push_back(part - least);
    }
    nodes_[n] = make_mesh_levels(mesh, parts, options);
  });
  for (const MeshLevels& node : nodes_) {
    errors_.emplace_back();
    triangles_.emplace_back();
    for (const MeshLevel& level : node.levels) {
      errors_.back().push_back(level.error);
      triangles_.back().push_back(level.triangles.size());
    }
  }
}

std::vector<std::string> SceneLevels::remarks() const {
  std::vector<std::string> out;
  for (std::size_t n = 0; n < nodes_.size(); ++n)
    if (!nodes_[n].why_not.empty())
      out.push_back("'" + names_[n] + "' is always drawn with all of its " + std::to_string(triangles_[n][0]) +
                    " triangles: " + nodes_[n].why_not);
  return out;
}

}  // namespace foresight
