// A picture file that a user names: read whole, checked, decoded.
#pragma once

#include <filesystem>

#include "pictures/decode.hpp"

namespace foresight {

/// Whether its name ends as that of a picture: png, jpg, jpeg, bmp, pgm, ppm, tif or tiff, in any case.
bool names_picture(const std::filesystem::path& file);

/// Says nothing on the error stream. Throws InputError naming the file: no regular file, no picture, one that is cut
/// off or damaged, where the decoder would deliver grey in place of what is missing. Any thread.
cv::Mat read_picture(const std::filesystem::path& file, PictureColours colours);

}  // namespace foresight
