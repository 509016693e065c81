// Files that are named inside of others.
#pragma once

#include <filesystem>
#include <vector>

namespace foresight {

/// `file`, and all files that it names, that those name, and so on: a rig's URDF, its meshes, lens files and results; a
/// scene's meshes. Every word in a text file (YAML, URDF, JSON, plain) counts that is the path of a file, relative to
/// the one in which it stands, or after package://NAME/ to a folder above. Reads text files of up to 4 MiB, four deep;
/// what cannot be read names nothing.
std::vector<std::filesystem::path> with_named_files(const std::filesystem::path& file);

}  // namespace foresight
