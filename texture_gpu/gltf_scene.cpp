#include "texture_gpu/gltf_scene.hpp"

#include <map>

namespace foresight {

std::vector<GltfNode> gltf_nodes(const SceneModel& scene, const SceneState& state, const SurfacePatches& surface,
                                 const BakedAtlas& atlas) {
  std::vector<GltfNode> out;
  std::size_t scene_triangle = 0;
  for (std::size_t n = 0; n < scene.nodes().size(); ++n) {
    const Node& node = scene.nodes()[n];
    GltfNode& textured = out.emplace_back();
    textured.name = node.name;
    textured.T_world_node = state.T_world_node[n];
    std::map<std::pair<std::uint32_t, int>, std::uint32_t> known;  // vertex of the mesh, patch
    for (const auto& triangle : node.mesh.triangles) {
      const int patch = surface.patch_of_triangle[scene_triangle++];
      auto& corners = textured.triangles.emplace_back();
      for (std::size_t i = 0; i < 3; ++i) {
        const auto fresh = static_cast<std::uint32_t>(textured.vertices.size());
        const auto [entry, is_new] = known.try_emplace({triangle[i], patch}, fresh);
        corners[i] = entry->second;
        if (!is_new) continue;
        const Eigen::Vector3f& p = node.mesh.vertices[triangle[i]];
        textured.vertices.push_back(p);
        textured.texcoords.push_back(atlas.texcoord(surface, patch, p.cast<double>()).cast<float>());
      }
    }
  }
  return out;
}

}  // namespace foresight
