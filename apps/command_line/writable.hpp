// Whether something can be written, found out by trying.
#pragma once

#include <filesystem>
#include <string>

namespace foresight {

/// `path` may be missing, and so may the folders above it. A file is made beside it (`inside`: in it, where it is a
/// folder) and removed again, and so are folders; a pipe must have a reader. Throws InputError at `where`.
void require_writable(const std::string& where, const std::filesystem::path& path, bool inside);

}  // namespace foresight
