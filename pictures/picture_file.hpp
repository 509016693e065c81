// Picture files: those that a user names, read whole, checked, decoded; and written ones.
#pragma once

#include <filesystem>

#include "pictures/decode.hpp"

namespace foresight {

/// Whether its name ends as that of a picture: png, jpg, jpeg, bmp, pgm, ppm, tif or tiff, in any case.
bool names_picture(const std::filesystem::path& file);

/// Says nothing on the error stream. Throws InputError naming the file: no regular file, no picture, one that is cut
/// off or damaged, where the decoder would deliver grey in place of what is missing. Any thread.
cv::Mat read_picture(const std::filesystem::path& file, PictureColours colours);

/// Atomically. Throws RuntimeFailure; of other pixels, what encode_png() does. Any thread.
void write_png(const std::filesystem::path& file, const cv::Mat& picture);

}  // namespace foresight
