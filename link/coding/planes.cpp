#include "link/coding/planes.hpp"

#include <algorithm>
#include <cstring>
#include <opencv2/imgproc.hpp>

namespace foresight {
namespace {

cv::Mat padded(const cv::Mat& picture) {
  const cv::Size size = even_size(picture.cols, picture.rows);
  if (size == picture.size()) return picture;
  cv::Mat out;
  cv::copyMakeBorder(picture, out, 0, size.height - picture.rows, 0, size.width - picture.cols, cv::BORDER_REPLICATE);
  return out;
}

/// One eye's I420 into its half of `planes`.
void put_eye(const cv::Mat& picture, Planes& planes, int first_row) {
  const cv::Mat eye = padded(picture);
  const auto luma = static_cast<std::size_t>(eye.total()), chroma = luma / 4;
  const auto above = static_cast<std::size_t>(first_row * eye.cols);
  if (eye.channels() == 1) {
    for (int row = 0; row < eye.rows; ++row)
      std::memcpy(planes.y() + above + static_cast<std::size_t>(row * eye.cols), eye.ptr(row),
                  static_cast<std::size_t>(eye.cols));
    std::fill_n(planes.u() + above / 4, chroma, std::uint8_t{128});
    std::fill_n(planes.v() + above / 4, chroma, std::uint8_t{128});
    return;
  }
  cv::Mat i420;
  cv::cvtColor(eye, i420, cv::COLOR_BGR2YUV_I420);
  std::memcpy(planes.y() + above, i420.data, luma);
  std::memcpy(planes.u() + above / 4, i420.data + luma, chroma);
  std::memcpy(planes.v() + above / 4, i420.data + luma + chroma, chroma);
}

cv::Mat take_eye(const Planes& planes, cv::Size eye, int first_row, bool colour) {
  const auto luma = static_cast<std::size_t>(eye.area()), above = static_cast<std::size_t>(first_row * eye.width);
  const auto all = static_cast<std::size_t>(planes.size.area());
  if (!colour) {
    cv::Mat grey(eye, CV_8UC1);
    std::memcpy(grey.data, planes.y() + above, luma);
    return grey;
  }
  cv::Mat i420(eye.height * 3 / 2, eye.width, CV_8UC1), out;
  std::memcpy(i420.data, planes.y() + above, luma);
  std::memcpy(i420.data + luma, planes.y() + all + above / 4, luma / 4);
  std::memcpy(i420.data + luma + luma / 4, planes.y() + all + all / 4 + above / 4, luma / 4);
  cv::cvtColor(i420, out, cv::COLOR_YUV2BGR_I420);
  return out;
}

}  // namespace

cv::Size even_size(int width, int height) {
  return {width + width % 2, height + height % 2};
}

Planes to_planes(const StereoPicture& picture) {
  const bool stereo = !picture.right.empty();
  cv::Size size = even_size(picture.left.cols, picture.left.rows);
  const int rows = size.height;
  if (stereo) size.height *= 2;
  Planes planes{size, std::vector<std::uint8_t>(static_cast<std::size_t>(size.area() * 3 / 2))};
  put_eye(picture.left, planes, 0);
  if (stereo) put_eye(picture.right, planes, rows);
  return planes;
}

StereoPicture halve(const StereoPicture& picture) {
  const cv::Size size((picture.left.cols + 1) / 2, (picture.left.rows + 1) / 2);
  StereoPicture out{.captured = picture.captured};
  cv::resize(picture.left, out.left, size, 0, 0, cv::INTER_AREA);
  if (!picture.right.empty()) cv::resize(picture.right, out.right, size, 0, 0, cv::INTER_AREA);
  return out;
}

StereoPicture enlarge(const StereoPicture& picture, cv::Size size) {
  StereoPicture out{.captured = picture.captured};
  cv::resize(picture.left, out.left, size, 0, 0, cv::INTER_CUBIC);
  if (!picture.right.empty()) cv::resize(picture.right, out.right, size, 0, 0, cv::INTER_CUBIC);
  return out;
}

void soften(Planes& planes, double sigma) {
  if (sigma < 1.0 / 3) return;
  const auto smooth = [](std::uint8_t* pixels, cv::Size size, double by) {
    cv::Mat plane(size, CV_8UC1, pixels);
    cv::GaussianBlur(plane, plane, {}, by);
  };
  smooth(planes.y(), planes.size, sigma);
  smooth(planes.u(), planes.size / 2, sigma / 2);
  smooth(planes.v(), planes.size / 2, sigma / 2);
}

StereoPicture from_planes(const Planes& planes, int width, int height, bool colour, bool stereo) {
  const cv::Size eye = even_size(width, height);
  const cv::Rect seen(0, 0, width, height);
  StereoPicture out;
  out.left = take_eye(planes, eye, 0, colour)(seen);
  if (stereo) out.right = take_eye(planes, eye, eye.height, colour)(seen);
  return out;
}

}  // namespace foresight
