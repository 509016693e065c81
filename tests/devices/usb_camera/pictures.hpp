// What the emulated camera shows: the images of a folder, in the forms that it sends.
#pragma once

#include <filesystem>

#include "little_endian.hpp"

namespace foresight::usb {

struct Picture {
  Bytes yuyv, jpeg;
};

struct Pictures {
  int width = 0, height = 0;  ///< px, even width
  std::vector<Picture> pictures;
};

/// All PNG files of the folder in the order of their names. Throws std::runtime_error: none, sizes that differ, an odd
/// width, a file that is no image.
Pictures read_pictures(const std::filesystem::path& folder);

}  // namespace foresight::usb
