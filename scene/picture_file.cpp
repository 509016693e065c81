#include "scene/picture_file.hpp"

#include <opencv2/imgcodecs.hpp>
#include <string_view>

#include "common/error.hpp"
#include "common/held_stderr.hpp"
#include "common/read_file.hpp"
#include "scene/image_structure.hpp"

namespace foresight {
namespace {

constexpr std::uintmax_t kLargest = 0x40000000;  // bytes

// What libjpeg says of a picture whose end or middle it made up; other libraries warn of things that change no pixel.
bool tells_of_damage(std::string_view said) {
  for (const std::string_view word : {"orrupt", "remature", "libpng error", "CRC error"})
    if (said.find(word) != std::string_view::npos) return true;
  return false;
}

}  // namespace

cv::Mat read_picture(const std::filesystem::path& file, int flags) {
  const std::string bytes = read_file(file, kLargest);
  const std::string_view start = std::string_view(bytes).substr(0, 4);
  if (start.starts_with("\x89PNG") || start.starts_with("\xff\xd8")) read_image_form(bytes, file);
  cv::Mat pixels;
  std::string said;
  if (!bytes.empty()) {
    const HeldStderr held;
    try {
      const cv::Mat encoded(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data()));
      pixels = cv::imdecode(encoded, flags);
    } catch (const cv::Exception&) {
      pixels.release();
    }
    said = held.text();
  }
  if (pixels.empty()) throw InputError(file.string(), "is no image that can be read", "remove it, or copy it again");
  if (tells_of_damage(said)) throw InputError(file.string(), "its compressed data are damaged", "copy it again");
  return pixels;
}

}  // namespace foresight
