// Files from outside, read whole.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace foresight {

/// Throws InputError naming the file: missing, a folder, a device.
void require_regular_file(const std::filesystem::path& file);

/// The whole content. Throws like require_regular_file, and where it cannot be read or has more than `largest` bytes.
std::string read_file(const std::filesystem::path& file, std::uintmax_t largest = UINTMAX_MAX);

}  // namespace foresight
