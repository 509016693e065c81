// The scene with its baked textures, in the form that scene/gltf_writer.hpp writes.
#pragma once

#include "scene/gltf_writer.hpp"
#include "texture_gpu/baked_atlas.hpp"

namespace foresight {

/// One node for each node of `scene`, where `state` says. All triangles in their order; a vertex on
/// a seam between patches becomes one for each of them.
std::vector<GltfNode> gltf_nodes(const SceneModel& scene, const SceneState& state, const SurfacePatches& surface,
                                 const BakedAtlas& atlas);

}  // namespace foresight
