#include "pictures/picture_file.hpp"

#include <algorithm>
#include <cctype>

#include "common/atomic_file.hpp"
#include "common/error.hpp"
#include "common/read_file.hpp"
#include "common/text.hpp"
#include "pictures/encode.hpp"
#include "pictures/image_structure.hpp"

namespace foresight {
namespace {

constexpr std::uintmax_t kLargest = 0x40000000;  // bytes

}  // namespace

bool names_picture(const std::filesystem::path& file) {
  const std::string ending = lower(file.extension().string());
  constexpr std::string_view kEndings[] = {".png", ".jpg", ".jpeg", ".bmp", ".pgm", ".ppm", ".tif", ".tiff"};
  return std::ranges::find(kEndings, ending) != std::end(kEndings);
}

cv::Mat read_picture(const std::filesystem::path& file, PictureColours colours) {
  const std::string bytes = read_file(file, kLargest);
  if (bytes.starts_with("\x89PNG") || bytes.starts_with("\xff\xd8")) read_image_form(bytes, file);
  const DecodedPicture picture = decode_picture(bytes, colours);
  if (picture.pixels.empty())
    throw InputError(file.string(), "is no image that can be read", "remove it, or copy it again");
  if (!picture.damage.empty()) throw InputError(file.string(), "its compressed data are damaged", "copy it again");
  return picture.pixels;
}

void write_png(const std::filesystem::path& file, const cv::Mat& picture) {
  const std::vector<std::uint8_t> bytes = encode_png(picture, 3);
  write_file_atomically(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace foresight
