// A picture file that a user names: read whole, checked, decoded.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

namespace foresight {

/// Decodes an image file as cv::imread does with `flags` (cv::ImreadModes). Says nothing on the error stream. Throws
/// InputError naming the file: no regular file, no picture, one that is cut off or damaged, where the decoder would
/// deliver grey in place of what is missing. Any thread.
cv::Mat read_picture(const std::filesystem::path& file, int flags);

}  // namespace foresight
