#include "pictures/decode.hpp"

#include "pictures/encode.hpp"
#include "pictures/formats.hpp"

namespace foresight {

DecodedPicture decode_picture(std::string_view bytes, PictureColours colours) {
  using namespace std::string_view_literals;
  if (bytes.starts_with("\x89PNG"sv)) return decode_png(bytes, colours);
  if (bytes.starts_with("\xff\xd8"sv)) return decode_jpeg(bytes, colours);
  if (bytes.starts_with("II*\0"sv) || bytes.starts_with("MM\0*"sv)) return decode_tiff(bytes, colours);
  if (bytes.starts_with("BM"sv)) return decode_bmp(bytes, colours);
  if (bytes.starts_with("P5"sv) || bytes.starts_with("P6"sv)) return decode_pnm(bytes, colours);
  return {};
}

std::vector<std::uint8_t> encode_for(const std::string& ending, const cv::Mat& pixels, int jpeg_quality) {
  return ending == ".png" ? encode_png(pixels) : encode_jpeg(pixels, jpeg_quality);
}

}  // namespace foresight
