// Three pictures side by side: delayed, predicted, actual.
#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "display/window_picture.hpp"
#include "gl/glfw_window.hpp"

namespace foresight {

/// Belongs to the window's context.
class ComparisonWindow {
 public:
  ComparisonWindow();

  /// Draws the pictures (CV_8UC3 BGR or CV_8UC4 BGRA) as large as they fit, from left to right. Does not present.
  void draw(const gl::Window& window, const cv::Mat& delayed, const cv::Mat& predicted, const cv::Mat& actual);

 private:
  std::array<WindowPicture, 3> pictures_;
};

}  // namespace foresight
