// Three pictures side by side: delayed, predicted, actual.
#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "gl/glfw_window.hpp"
#include "gl/objects.hpp"

namespace foresight {

/// Belongs to the window's context.
class ComparisonWindow {
 public:
  /// Size of each picture in px.
  ComparisonWindow(int width, int height);

  /// Draws the pictures (CV_8UC3 BGR or CV_8UC4 BGRA, of the given size) as large as they fit,
  /// from left to right. Does not present.
  void draw(const gl::Window& window, const cv::Mat& delayed, const cv::Mat& predicted, const cv::Mat& actual);

 private:
  std::array<gl::Texture, 3> pictures_;
  gl::Framebuffer framebuffer_;
};

}  // namespace foresight
