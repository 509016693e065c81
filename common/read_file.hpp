// Files from outside: the one way in which they are opened.
//
// An input is a regular file. A pipe could wait for ever and a device never end, and what is checked as a whole before
// the work begins cannot come from one; /dev/stdin is fine where a file was redirected to it (`< FILE`). Each kind has
// a size that no right one has, so that a wrong one does not fill the memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

namespace foresight {

inline constexpr std::uintmax_t kLargestText = std::uintmax_t{256} << 20;   ///< rigs, models of robots, results; images
inline constexpr std::uintmax_t kLargestTable = std::uintmax_t{1} << 30;    ///< rows of numbers (text_rows.hpp)
inline constexpr std::uintmax_t kLargestMesh = std::uintmax_t{4} << 30;     ///< PLY and the like
inline constexpr std::uintmax_t kLargestStream = std::uintmax_t{64} << 30;  ///< read piece by piece: logs of CAN frames

/// Throws InputError naming the file: missing, a folder, a device, a pipe, or more than `largest` bytes.
void require_regular_file(const std::filesystem::path& file, std::uintmax_t largest = UINTMAX_MAX);

/// Throws InputError where there is neither a file nor a folder of that name.
void require_there(const std::filesystem::path& path);

/// The whole content. Throws like require_regular_file, and where it cannot be read. Never waits.
std::string read_file(const std::filesystem::path& file, std::uintmax_t largest = kLargestText);

/// For what is read piece by piece. Throws the same.
std::ifstream open_input(const std::filesystem::path& file, std::uintmax_t largest = kLargestStream);

}  // namespace foresight
