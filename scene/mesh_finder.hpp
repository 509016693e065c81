// Where the mesh files lie that a URDF names.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace foresight {

struct MeshSearch {
  /// Canonical. Nothing outside of it is looked for or read: that of a run folder, which may come from anybody.
  std::optional<std::filesystem::path> inside;
  /// Looked into before all other folders: what a rig calls robot.mesh_root.
  std::optional<std::filesystem::path> root;
};

/// The file of the mesh `name` in the URDF `urdf`; the first that exists of
///
///     package://NAME/PATH  in `root`: NAME/PATH, PATH; then in each folder from the URDF's upward: NAME/PATH, and PATH
///                          where the folder is called NAME or its package.xml says so; at last PATH beside the URDF
///                          and one folder above it: a package whose folder was renamed
///     PATH                 in `root`, then in each folder from the URDF's upward
///     file:///PATH, /PATH  there; else in `root`: the longest end of PATH
///
/// A URDF that is a link is looked for from where it points to as well. model:// counts as package://. Throws
/// InputError at `where`: no such file, with every place that was looked at; another scheme; an absolute path, or one
/// that leads out, where the search is confined.
std::filesystem::path find_mesh(const std::string& name, const std::filesystem::path& urdf, const MeshSearch& search,
                                const std::string& where);

}  // namespace foresight
