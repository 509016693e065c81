// Files that nothing was written to.
#pragma once

#include <filesystem>

namespace foresight {

/// Leaves alone what holds something, and what is no regular file.
void remove_empty(const std::filesystem::path& file) noexcept;

}  // namespace foresight
