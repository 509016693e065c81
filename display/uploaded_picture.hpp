// A picture from the CPU, such as a camera's image, as a texture that can be shown.
#pragma once

#include <opencv2/core.hpp>

#include "gl/objects.hpp"

namespace foresight {

/// Belongs to one context.
class UploadedPicture {
 public:
  /// `label` shows up in GL debuggers.
  explicit UploadedPicture(const char* label) : label_(label) {}

  /// `source`: CV_8UC1, CV_8UC3 (BGR) or CV_8UC4 (BGRA), continuous, not empty, of any size.
  void upload(const cv::Mat& source);
  bool empty() const { return !texture_; }
  /// RGBA8, row 0 at the top.
  const gl::Texture& texture() const { return texture_; }

 private:
  const char* label_;
  gl::Texture texture_;
};

}  // namespace foresight
