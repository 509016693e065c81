// Reads one mesh file: PLY by our own reader (scene/ply_reader.hpp says why), the rest through assimp.
#pragma once

#include <filesystem>

#include "scene/mesh.hpp"

namespace foresight {

/// Reads .ply .obj .stl .gltf .glb .dae: all meshes of the file, with their node transforms
/// applied, axes as written (a Collada up_axis is not applied, as robot descriptions expect);
/// polygons are triangulated, vertices at one place welded, vertices that no triangle uses and
/// degenerate triangles (height under a millionth of the longest side) dropped, the latter
/// counted. Files that the mesh names must lie beside or beneath it. Throws InputError naming the
/// file: missing, unreadable, no faces, a vertex that is not finite, an index out of range.
Mesh read_mesh(const std::filesystem::path& file);

}  // namespace foresight
