#include "pictures.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

namespace foresight::usb {
namespace {

constexpr int kJpegQuality = 90;

std::uint8_t rounded(double value) {
  return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0l, 255l));
}

/// BT.601, 16 .. 235; two pixels share the mean of their colours.
Bytes to_yuyv(const cv::Mat& bgr) {
  Bytes out;
  out.reserve(bgr.total() * 2);
  for (int y = 0; y < bgr.rows; ++y) {
    const auto* row = bgr.ptr<cv::Vec3b>(y);
    for (int x = 0; x < bgr.cols; x += 2) {
      const auto luma = [](const cv::Vec3b& p) { return 16 + (24.966 * p[0] + 128.553 * p[1] + 65.481 * p[2]) / 255; };
      const double b = (row[x][0] + row[x + 1][0]) / 510., g = (row[x][1] + row[x + 1][1]) / 510.,
                   r = (row[x][2] + row[x + 1][2]) / 510.;
      out.push_back(rounded(luma(row[x])));
      out.push_back(rounded(128 + 112 * b - 74.203 * g - 37.797 * r));
      out.push_back(rounded(luma(row[x + 1])));
      out.push_back(rounded(128 - 18.214 * b - 93.786 * g + 112 * r));
    }
  }
  return out;
}

}  // namespace

Pictures read_pictures(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".png") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.empty()) throw std::runtime_error(folder.string() + " has no PNG files; give the images of a run");
  Pictures out;
  for (const auto& file : files) {
    const cv::Mat image = cv::imread(file.string(), cv::IMREAD_COLOR);
    if (image.empty()) throw std::runtime_error(file.string() + " is no image");
    if (out.pictures.empty()) {
      out.width = image.cols;
      out.height = image.rows;
    }
    if (image.cols != out.width || image.rows != out.height || image.cols % 2 != 0)
      throw std::runtime_error(file.string() + " is " + std::to_string(image.cols) + "x" + std::to_string(image.rows) +
                               "; give images of one size and even width");
    Picture picture;
    picture.yuyv = to_yuyv(image);
    cv::imencode(".jpg", image, picture.jpeg, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
    out.pictures.push_back(std::move(picture));
  }
  return out;
}

}  // namespace foresight::usb
