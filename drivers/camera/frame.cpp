#include "drivers/camera/frame.hpp"

#include <opencv2/imgproc.hpp>
#include <vector>

#include "common/error.hpp"
#include "common/text.hpp"
#include "pictures/decode.hpp"

namespace foresight {
namespace {

struct Form {
  const char* name;
  int bytes_per_pixel;  // of the first plane; 0: compressed
  int width_step, height_step;
  int conversion;  // cv::ColorConversionCodes; -1: none
};

// Index: PixelFormat.
constexpr Form kForms[] = {
    {"yuyv", 2, 2, 1, cv::COLOR_YUV2BGR_YUY2},
    {"nv12", 1, 2, 2, cv::COLOR_YUV2BGR_NV12},
    {"mjpeg", 0, 1, 1, -1},
    {"grey", 1, 1, 1, cv::COLOR_GRAY2BGR},
    {"bayer_rggb8", 1, 2, 2, cv::COLOR_BayerRGGB2BGR},
    {"bayer_bggr8", 1, 2, 2, cv::COLOR_BayerBGGR2BGR},
    {"bayer_gbrg8", 1, 2, 2, cv::COLOR_BayerGBRG2BGR},
    {"bayer_grbg8", 1, 2, 2, cv::COLOR_BayerGRBG2BGR},
    {"bayer_rggb10", 2, 2, 2, cv::COLOR_BayerRGGB2BGR},
    {"bayer_bggr10", 2, 2, 2, cv::COLOR_BayerBGGR2BGR},
    {"bayer_gbrg10", 2, 2, 2, cv::COLOR_BayerGBRG2BGR},
    {"bayer_grbg10", 2, 2, 2, cv::COLOR_BayerGRBG2BGR},
    {"bgr", 3, 1, 1, -1},
};

const Form& form_of(PixelFormat format) {
  return kForms[static_cast<std::size_t>(format)];
}

// Decoders fill up what is missing with grey, so the end is looked for first. Cameras pad with zeros.
bool has_jpeg_end(std::span<const std::uint8_t> bytes) {
  std::size_t n = bytes.size();
  while (n > 0 && bytes[n - 1] == 0) --n;
  return n >= 4 && bytes[n - 2] == 0xFF && bytes[n - 1] == 0xD9;
}

Conversion decode_jpeg(const CameraFrame& frame, cv::Mat& out) {
  const auto bytes = frame.bytes;
  if (bytes.size() < 4) return Conversion::truncated;
  if (bytes[0] != 0xFF || bytes[1] != 0xD8) return Conversion::damaged;
  if (!has_jpeg_end(bytes)) return Conversion::truncated;
  const std::string_view packed(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  out = decode_picture(packed, PictureColours::colour).pixels;
  return out.cols == frame.width && out.rows == frame.height ? Conversion::ok : Conversion::damaged;
}

Conversion convert_raw(const CameraFrame& frame, const Form& form, cv::Mat& out) {
  const int rows = frame.format == PixelFormat::nv12 ? frame.height * 3 / 2 : frame.height;
  const auto row_bytes = static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(form.bytes_per_pixel);
  if (frame.stride < row_bytes || frame.width % form.width_step != 0 || frame.height % form.height_step != 0) {
    return Conversion::damaged;
  }
  if (frame.bytes.size() < frame.stride * static_cast<std::size_t>(rows - 1) + row_bytes) return Conversion::truncated;
  const bool wide = frame.format >= PixelFormat::bayer_rggb10 && frame.format <= PixelFormat::bayer_grbg10;
  const int type = wide ? CV_16UC1 : CV_8UC(form.bytes_per_pixel);
  const cv::Mat raw(rows, frame.width, type, const_cast<std::uint8_t*>(frame.bytes.data()), frame.stride);
  if (frame.format == PixelFormat::bgr) {
    raw.copyTo(out);
  } else if (wide) {
    cv::Mat narrow;
    raw.convertTo(narrow, CV_8U, 0.25, -0.375);  // rounds down, as if the lowest two bits were never there
    cv::cvtColor(narrow, out, form.conversion);
  } else {
    cv::cvtColor(raw, out, form.conversion);
  }
  return Conversion::ok;
}

}  // namespace

const char* to_string(PixelFormat format) {
  return form_of(format).name;
}

PixelFormat parse_pixel_format(std::string_view name, const std::string& where) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < std::size(kForms); ++i) {
    if (kForms[i].name == name) return static_cast<PixelFormat>(i);
    names.emplace_back(kForms[i].name);
  }
  throw InputError(where, "there is no pixel format " + in_quotes(name), did_you_mean(name, names));
}

Conversion to_bgr(const CameraFrame& frame, cv::Mat& out) noexcept {
  try {
    if (frame.width <= 0 || frame.height <= 0) return Conversion::damaged;
    if (out.u != nullptr && out.u->refcount > 1) out.release();
    if (frame.format == PixelFormat::mjpeg) return decode_jpeg(frame, out);
    return convert_raw(frame, form_of(frame.format), out);
  } catch (const std::exception&) {  // OpenCV says no by exceptions
    return Conversion::damaged;
  }
}

}  // namespace foresight
