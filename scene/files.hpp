// Files of a run folder: read and written whole, and never from outside the folder.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/read_file.hpp"

namespace foresight {

/// Both throw RuntimeFailure where the file cannot be written whole.
void write_bytes(const std::filesystem::path& file, const void* data, std::size_t size);
void write_text(const std::filesystem::path& file, const std::string& text);

/// `folder / name` for a `name` written in a file of the run. `root` is canonical, and `folder`
/// lies in it. Throws InputError at `where` when the name is empty, absolute, or leads out of
/// `root` (by ".." or a symbolic link), or when no regular file is there.
std::filesystem::path resolve_inside(const std::filesystem::path& root, const std::filesystem::path& folder,
                                     std::string_view name, const std::string& where);

/// Canonical path of an existing folder; throws InputError otherwise.
std::filesystem::path canonical_folder(const std::filesystem::path& folder);

}  // namespace foresight
