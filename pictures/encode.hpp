// Pixels to bytes of a picture file.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

namespace foresight {

/// PNG 1.2 of 8 or 16 bits, of 1, 3 (BGR) or 4 (BGRA) channels. `effort`, 0 .. 9: zlib's; without one, quick: the size
/// is that of an effort of 1 or 2. Throws std::invalid_argument: other pixels, or none.
std::vector<std::uint8_t> encode_png(const cv::Mat& pixels, std::optional<int> effort = std::nullopt);

/// JPEG (ITU-T T.81) of CV_8UC1 or CV_8UC3 (BGR), the colours at half the resolution. `quality`: 1 .. 100. Throws
/// std::invalid_argument: other pixels, none, or more than 65500 a side.
std::vector<std::uint8_t> encode_jpeg(const cv::Mat& pixels, int quality);

/// One of both, by what a file's name ends with: ".png", else JPEG.
std::vector<std::uint8_t> encode_for(const std::string& ending, const cv::Mat& pixels, int jpeg_quality);

}  // namespace foresight
