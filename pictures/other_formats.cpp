#include <stb/stb_image.h>
#include <tiffio.h>
#include <tiffio.hxx>

#include <charconv>
#include <cstring>
#include <memory>
#include <mutex>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <utility>

#include "pictures/formats.hpp"

namespace foresight {
namespace {

/// Of red first, of 1 to 4 channels.
cv::Mat from_rgb(const cv::Mat& rgb, PictureColours colours) {
  const bool grey = colours == PictureColours::grey || (colours == PictureColours::as_stored && rgb.channels() < 3);
  const bool alpha = colours == PictureColours::as_stored && rgb.channels() == 4;
  cv::Mat out;
  switch (rgb.channels()) {
    case 1: grey ? rgb.copyTo(out) : cv::cvtColor(rgb, out, cv::COLOR_GRAY2BGR); break;
    case 3: cv::cvtColor(rgb, out, grey ? cv::COLOR_RGB2GRAY : cv::COLOR_RGB2BGR); break;
    case 4:
      cv::cvtColor(rgb, out, grey ? cv::COLOR_RGBA2GRAY : alpha ? cv::COLOR_RGBA2BGRA : cv::COLOR_RGBA2BGR);
      break;
    default: break;  // none of these formats has two
  }
  return out;
}

}  // namespace

// Netpbm's "pgm" and "ppm", binary: magic, width, height and largest value as words, one blank, samples row by row.
DecodedPicture decode_pnm(std::string_view bytes, PictureColours colours) {
  std::size_t at = 2;
  const auto number = [&] {
    const auto blank = [](char c) { return c == ' ' || (c >= '\t' && c <= '\r'); };
    while (at < bytes.size() && (blank(bytes[at]) || bytes[at] == '#'))
      at = bytes[at] == '#' ? std::min(bytes.find('\n', at), bytes.size()) : at + 1;
    std::int64_t value = 0;
    const auto end = std::from_chars(bytes.data() + at, bytes.data() + bytes.size(), value);
    at = static_cast<std::size_t>(end.ptr - bytes.data());
    return end.ec == std::errc{} ? value : 0;
  };
  const std::int64_t width = number(), height = number(), largest = number();
  if (!bearable(width, height) || largest < 1 || largest > 65535 || ++at > bytes.size()) return {};
  cv::Mat rgb(static_cast<int>(height), static_cast<int>(width),
              CV_MAKETYPE(largest > 255 ? CV_16U : CV_8U, bytes[1] == '5' ? 1 : 3));
  const std::size_t size = rgb.total() * rgb.elemSize();
  if (bytes.size() - at < size) return {};
  std::memcpy(rgb.data, bytes.data() + at, size);
  if (largest > 255) {  // the higher byte first
    for (std::size_t i = 0; i < size; i += 2) std::swap(rgb.data[i], rgb.data[i + 1]);
    if (colours != PictureColours::as_stored) rgb.convertTo(rgb, CV_8U, 1 / 256.0, -0.5 + 1 / 512.0);
  }
  return {from_rgb(rgb, colours), {}};
}

// The library fills with black what a file lacks, so its size is looked at first.
DecodedPicture decode_bmp(std::string_view bytes, PictureColours colours) {
  constexpr std::size_t kHeader = 54;
  if (bytes.size() < kHeader) return {};
  const auto field = [&](std::size_t at, std::size_t size) {
    std::uint32_t value = 0;
    for (std::size_t i = size; i-- > 0;) value = value << 8 | static_cast<std::uint8_t>(bytes[at + i]);
    return value;
  };
  const std::int64_t begin = field(10, 4), columns = static_cast<std::int32_t>(field(18, 4)),
                     rows = std::abs(std::int64_t{static_cast<std::int32_t>(field(22, 4))}), bits = field(28, 2);
  if (!bearable(columns, rows) ||
      static_cast<std::int64_t>(bytes.size()) < begin + (columns * bits + 31) / 32 * 4 * rows)
    return {};
  int width = 0, height = 0, channels = 0;
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()), static_cast<int>(bytes.size()), &width,
                            &height, &channels, 0),
      stbi_image_free);
  if (!pixels) return {};
  cv::Mat rgb(height, width, CV_MAKETYPE(CV_8U, channels), pixels.get());
  if (bits <= 8 && channels == 3) {  // grey is stored as a palette of greys
    cv::Mat planes[3];
    cv::split(rgb, planes);
    if (cv::norm(planes[0], planes[1], cv::NORM_INF) + cv::norm(planes[0], planes[2], cv::NORM_INF) == 0)
      return {from_rgb(planes[0], colours), {}};
  }
  return {from_rgb(rgb, colours), {}};
}

DecodedPicture decode_tiff(std::string_view bytes, PictureColours colours) {
  static std::once_flag quiet;
  std::call_once(quiet, [] {
    TIFFSetErrorHandler(nullptr);
    TIFFSetWarningHandler(nullptr);
  });
  std::istringstream stream{std::string(bytes)};
  const std::unique_ptr<TIFF, void (*)(TIFF*)> tiff(TIFFStreamOpen("a picture", &stream), TIFFClose);
  std::uint32_t width = 0, height = 0;
  std::uint16_t bits = 1, samples = 1, photometric = PHOTOMETRIC_RGB;
  if (!tiff || !TIFFGetField(tiff.get(), TIFFTAG_IMAGEWIDTH, &width) ||
      !TIFFGetField(tiff.get(), TIFFTAG_IMAGELENGTH, &height) || !bearable(width, height))
    return {};
  TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_BITSPERSAMPLE, &bits);
  TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_SAMPLESPERPIXEL, &samples);
  TIFFGetField(tiff.get(), TIFFTAG_PHOTOMETRIC, &photometric);
  if (bits != 8) return {};
  const bool grey = photometric == PHOTOMETRIC_MINISBLACK || photometric == PHOTOMETRIC_MINISWHITE;
  cv::Mat rgba(static_cast<int>(height), static_cast<int>(width),
               CV_8UC4);  // bytes in this order on all that we run on
  if (!TIFFReadRGBAImageOriented(tiff.get(), width, height, rgba.ptr<std::uint32_t>(), ORIENTATION_TOPLEFT, 1))
    return {};
  if (colours == PictureColours::as_stored && grey && samples == 1) colours = PictureColours::grey;
  if (colours == PictureColours::as_stored && samples == 3) colours = PictureColours::colour;
  if (grey && colours == PictureColours::grey) {  // all channels are alike: no sum is rounded
    cv::Mat out;
    cv::extractChannel(rgba, out, 0);
    return {out, {}};
  }
  return {from_rgb(rgba, colours), {}};
}

}  // namespace foresight
