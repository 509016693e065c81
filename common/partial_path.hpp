// Names for what is not complete yet, and the end of those that a dead program left.
#pragma once

#include <filesystem>

namespace foresight {

/// `path` without the slash that a folder's name may end in.
std::filesystem::path without_end_slash(const std::filesystem::path& path);

/// Where what will be `target` is written until it is complete: its neighbour "NAME.partial-PID". A folder's name may
/// end in a slash.
std::filesystem::path partial_path(const std::filesystem::path& target);

/// Whether it has such a name, whoever wrote it.
bool is_partial(const std::filesystem::path& path);

/// Removes such neighbours of `target` (files and folders) whose program no longer runs. What cannot be removed stays.
void sweep_partials(const std::filesystem::path& target) noexcept;

/// The same for all of them that lie in `folder` itself.
void sweep_partials_in(const std::filesystem::path& folder) noexcept;

}  // namespace foresight
