#include "pictures/image_structure.hpp"

#include <zlib.h>

#include <cstdint>

#include "common/error.hpp"

namespace foresight {
namespace {

constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n";

std::uint32_t crc(std::string_view bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

class Walk {
 public:
  Walk(std::string_view bytes, const std::filesystem::path& file) : bytes_(bytes), file_(file) {}

  ImageForm png() {
    at_ = kPngSignature.size();
    ImageForm form;
    bool has_data = false;
    for (bool first = true;; first = false) {
      const std::uint32_t length = big_endian(at_, 4);
      if (length > 0x7FFFFFFFu) fail_damaged();
      const std::string_view tagged = view(at_ + 4, std::size_t{length} + 4);  // type and data
      if (crc(tagged) != big_endian(at_ + 8 + length, 4)) fail_damaged();
      const std::string_view type = tagged.substr(0, 4);
      if (first != (type == "IHDR")) fail_damaged();
      if (first) form = png_header(length);
      if (type == "IDAT") has_data = true;
      if (type == "tRNS") form.has_alpha = true;
      if (type == "IEND") break;
      at_ += std::size_t{length} + 12;
    }
    if (!has_data) fail_damaged();
    return form;
  }

  ImageForm jpeg() {
    at_ = 2;  // behind SOI
    ImageForm form;
    bool has_scan = false;
    while (true) {
      const unsigned marker = next_marker();
      if (marker == 0xD9) break;                                           // EOI
      if (marker == 0x01 || (marker >= 0xD0 && marker <= 0xD7)) continue;  // TEM, RST: no content
      const std::size_t length = big_endian(at_, 2);
      if (length < 2) fail_damaged();
      view(at_, length);
      const bool is_frame = marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
      if (is_frame) form = jpeg_frame(length);
      at_ += length;
      if (marker == 0xDA) {  // SOS
        has_scan = true;
        skip_entropy_coded();
      }
    }
    if (form.width == 0 || !has_scan) fail_damaged();
    return form;
  }

 private:
  [[noreturn]] void fail_damaged() const {
    throw InputError(file_.string(), "the image is damaged near byte " + std::to_string(at_),
                     "copy or record it again, or remove its line");
  }

  std::string_view view(std::size_t at, std::size_t size) const {
    if (at > bytes_.size() || size > bytes_.size() - at)
      throw InputError(file_.string(), "the image is truncated after " + std::to_string(bytes_.size()) + " bytes",
                       "copy or record it again, or remove its line");
    return bytes_.substr(at, size);
  }

  std::uint32_t big_endian(std::size_t at, std::size_t size) const {
    std::uint32_t value = 0;
    for (char b : view(at, size)) value = value << 8 | static_cast<std::uint8_t>(b);
    return value;
  }

  ImageForm png_header(std::uint32_t length) const {
    if (length != 13) fail_damaged();
    const std::size_t data = at_ + 8;
    ImageForm form;
    form.width = static_cast<int>(big_endian(data, 4) & 0x7FFFFFFFu);
    form.height = static_cast<int>(big_endian(data + 4, 4) & 0x7FFFFFFFu);
    form.bits = static_cast<int>(big_endian(data + 8, 1));
    const std::uint32_t colour = big_endian(data + 9, 1);
    if (colour > 6 || colour == 1 || colour == 5) fail_damaged();
    if (colour == 3) form.bits = 8;  // the entries of a palette
    form.channels = colour == 0 || colour == 4 ? 1 : 3;
    form.has_alpha = colour == 4 || colour == 6;
    return form;
  }

  ImageForm jpeg_frame(std::size_t length) const {
    if (length < 8) fail_damaged();
    ImageForm form;
    form.bits = static_cast<int>(big_endian(at_ + 2, 1));
    form.height = static_cast<int>(big_endian(at_ + 3, 2));
    form.width = static_cast<int>(big_endian(at_ + 5, 2));
    form.channels = static_cast<int>(big_endian(at_ + 7, 1));
    return form;
  }

  unsigned next_marker() {
    if (big_endian(at_, 1) != 0xFF) fail_damaged();
    while (big_endian(at_, 1) == 0xFF) ++at_;  // any number of fill bytes
    return big_endian(at_++, 1);
  }

  // Up to the marker behind the scan; 0xFF00 and restart markers belong to its data.
  void skip_entropy_coded() {
    while (true) {
      const std::size_t ff = bytes_.find('\xFF', at_);
      at_ = ff == std::string_view::npos ? bytes_.size() : ff;
      const std::uint32_t next = big_endian(at_ + 1, 1);
      if (next != 0x00 && next != 0xFF && !(next >= 0xD0 && next <= 0xD7)) return;
      at_ += next == 0xFF ? 1 : 2;
    }
  }

  std::string_view bytes_;
  const std::filesystem::path& file_;
  std::size_t at_ = 0;
};

}  // namespace

ImageForm read_image_form(std::string_view bytes, const std::filesystem::path& file) {
  if (bytes.empty()) throw InputError(file.string(), "the image is empty", "copy or record it again");
  if (bytes.starts_with(kPngSignature)) return Walk(bytes, file).png();
  if (bytes.starts_with("\xFF\xD8\xFF")) return Walk(bytes, file).jpeg();
  throw InputError(file.string(), "is neither PNG nor JPEG", "convert it to PNG");
}

}  // namespace foresight
