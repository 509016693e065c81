// Checks a Collada file for what makes assimp 5.2 read out of bounds or never return.
#pragma once

#include <filesystem>

namespace foresight {

/// Throws InputError naming file and line: an array whose count is missing or differs from what
/// an accessor reads of it, an input beyond all indices, an index list (p, vcount) that holds anything
/// but indices, another number of lists than announced, no COLLADA element in UTF-8. All else is left to assimp.
void check_collada(const std::filesystem::path& file);

}  // namespace foresight
