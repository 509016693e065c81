// Files that are either complete or not there.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>

namespace foresight {

/// Writes `bytes` to a temporary file in the folder of `path` (partial_path.hpp) and renames it over `path`: whoever
/// reads `path`, at any time, sees the old content or all of the new one. Symbolic links are followed; a path that is
/// no regular file (a pipe, /dev/stdout) is written directly. Throws RuntimeFailure naming `path`, the cause and the
/// cure; no temporary file stays behind.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

struct FileContent {
  std::filesystem::path path;
  std::string_view bytes;
};

/// The same for files that belong together: none is renamed before all are written, so that a full
/// disk leaves the old ones, or none.
void write_files_atomically(std::span<const FileContent> files);

/// What to do about an errno of writing.
const char* cure_of_write_error(int error);

}  // namespace foresight
