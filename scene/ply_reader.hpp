// Reads PLY, the form in which scanned scenes come.
//
// Our own reader, because a scan is the one large and often damaged mesh that users bring: assimp
// takes the counts of a header on trust, fills what a truncated file lacks, and drops faces with
// indices out of range without a word. Source: Turk, "The PLY polygon file format", 1994.
#pragma once

#include <filesystem>

#include "scene/mesh.hpp"

namespace foresight {

/// Reads ascii, binary_little_endian and binary_big_endian; vertices have x, y, z, faces have
/// vertex_indices or vertex_index; other properties and elements are passed over. Throws
/// InputError naming file and line, vertex or face: a header that is not PLY's, fewer data than
/// the header announces, a coordinate that is not finite as a float, an index out of range, no face.
Mesh read_ply(const std::filesystem::path& file);

}  // namespace foresight
