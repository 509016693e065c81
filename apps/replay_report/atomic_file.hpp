// Files that are either complete or not there.
#pragma once

#include <filesystem>
#include <string_view>

namespace foresight {

/// Writes `bytes` to a temporary file in the folder of `path` and renames it over `path`: whoever
/// reads `path`, at any time, sees the old content or all of the new one. Symbolic links are
/// followed; a path that is no regular file (a pipe, /dev/stdout) is written directly.
/// Throws RuntimeFailure naming `path`, the cause and the cure; no temporary file stays behind.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

}  // namespace foresight
