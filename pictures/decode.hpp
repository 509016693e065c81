// Bytes of a picture file to pixels, as they lie in the file: what EXIF data say of turning them is not followed, as a
// lens belongs to the sensor's pixels.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <string_view>

namespace foresight {

enum class PictureColours {
  as_stored,  ///< CV_8UC1, CV_8UC3 (BGR), CV_8UC4 (BGRA), and the same of 16 bits; a palette counts as colour
  grey,       ///< CV_8UC1
  colour      ///< CV_8UC3 (BGR)
};

struct DecodedPicture {
  cv::Mat pixels;      ///< empty: no picture that can be decoded
  std::string damage;  ///< of a JPEG whose decoder made up for what is missing: the decoder's words; else ""
};

/// PNG, JPEG, BMP, PGM, PPM or TIFF, told by their first bytes; of TIFF only 8 bits. What is larger than kMostPixels is
/// not decoded. Says nothing on the error stream. Any thread.
constexpr std::int64_t kMostPixels = std::int64_t{1} << 28;
DecodedPicture decode_picture(std::string_view bytes, PictureColours colours);

}  // namespace foresight
