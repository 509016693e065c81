// Reads one mesh file through assimp.
#pragma once

#include <filesystem>

#include "scene/mesh.hpp"

namespace foresight {

/// Reads PLY, OBJ, STL or glTF (.ply .obj .stl .gltf .glb .dae): all meshes of the file, with their node
/// transforms applied, in metres as written; polygons are triangulated, equal vertices welded,
/// degenerate triangles dropped and counted. Throws InputError naming the file: unreadable, no
/// faces, a vertex that is not finite, an index out of range.
Mesh read_mesh(const std::filesystem::path& file);

}  // namespace foresight
