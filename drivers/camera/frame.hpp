// One image as a camera delivers it, and its conversion to colours.
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <string_view>

#include "common/time.hpp"

namespace foresight {

enum class PixelFormat : std::uint8_t {
  yuyv,   ///< Y0 U Y1 V; BT.601, 16 .. 235; even width
  nv12,   ///< Y plane, then interleaved UV at half the resolution, same stride; even width and height
  mjpeg,  ///< one JPEG per frame, also without Huffman tables
  grey,   ///< 8 bits
  bayer_rggb8,
  bayer_bggr8,
  bayer_gbrg8,
  bayer_grbg8,
  bayer_rggb10,  ///< 10 bits in the low bits of 16, little-endian, as all *10
  bayer_bggr10,
  bayer_gbrg10,
  bayer_grbg10,
  bgr,  ///< 8 bits each
};
const char* to_string(PixelFormat format);  ///< "yuyv", "bayer_rggb10"
/// By that name. Throws InputError, naming `where`, the word and the nearest known name.
PixelFormat parse_pixel_format(std::string_view name, const std::string& where);

/// A view of an image; copies share the pixels. Pixels belong to `pixels` or, where that is empty, to the camera, and
/// then are valid only until the camera's next call (Camera::wait_frame).
struct CameraFrame {
  PixelFormat format = PixelFormat::bgr;
  int width = 0, height = 0;            ///< px
  std::size_t stride = 0;               ///< bytes from row to row; 0 for mjpeg
  std::span<const std::uint8_t> bytes;  ///< all that was delivered
  cv::Mat pixels;                       ///< owner of `bytes`, where we own them
  int dmabuf = -1;                      ///< the same memory for the GPU, borrowed like `bytes`; -1: none
  std::uint64_t sequence = 0;           ///< as the camera counts; gaps are lost frames
  RobotTime time;                       ///< middle of the exposure of the middle row
  Duration uncertainty{0};              ///< of `time`, half width
};

enum class Conversion : std::uint8_t {
  ok,
  truncated,  ///< fewer bytes than the format needs, or a JPEG without its end
  damaged,    ///< not a picture of that size in that format
};
/// Writes an 8-bit BGR image of the frame's size (grey: three equal channels) to `out`, reusing its memory where that
/// fits and nobody else holds it. A JPEG with damage between whole markers is given as the decoder repaired it.
/// Demosaicing is bilinear; 10 bits lose the lowest two. `out` is left undefined unless ok. Any thread.
Conversion to_bgr(const CameraFrame& frame, cv::Mat& out) noexcept;

}  // namespace foresight
