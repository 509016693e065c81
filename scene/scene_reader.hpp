// Reads a scene: one mesh file, or a scene.yaml with nodes and robots.
#pragma once

#include <filesystem>

#include "scene/scene_model.hpp"

namespace foresight {

/// A mesh file becomes a model with the single node "scene". A .yaml file holds
///
///   nodes:
///     - name: table                        # unique
///       mesh: table.ply                    # relative to the yaml; optional
///       parent: world                      # an earlier node; optional
///       pose: {xyz: [m, m, m], quaternion: [x, y, z, w]}   # T_parent_node; optional
///   accuracy_m: 0.005                      # how far the model may be from the real surface; optional
///   robots:                                # optional
///     - urdf: arm.urdf                     # relative to the yaml
///       parent: table                      # optional
///       pose: {...}                        # T_parent_base; optional
///       joints: {shoulder: 0.5}            # rad or m; unnamed joints stand at 0 (or the nearest limit)
///       prefix: left_                      # in front of its link names; optional
///   cells:                                 # of a building (scene/cells.hpp); optional
///     - {name: hall, box: [[m, m, m], [m, m, m]], nodes: [hall_walls, table]}   # two corners; nodes that do not move
///   portals:
///     - {between: [hall, lab], corners: [[m, m, m], ...]}   # of an opening, in order around it
///
/// Links of a robot become nodes named by the link, posed by forward kinematics; visual meshes
/// (scene/urdf_reader.hpp says where they are looked for), boxes, cylinders and spheres are read.
/// Files named in the yaml must lie inside `root` (the run folder). Throws InputError naming file
/// and line or field: unknown key (with the nearest known one), missing name, duplicate or
/// unknown node, a path that leaves `root`, whatever read_mesh refuses.
SceneModel read_scene(const std::filesystem::path& file, const std::filesystem::path& root);

}  // namespace foresight
