// A picture from the CPU, drawn into a window.
#pragma once

#include <opencv2/core.hpp>

#include "gl/objects.hpp"

namespace foresight {

/// Belongs to the window's context.
class WindowPicture {
 public:
  /// `label` shows up in GL debuggers.
  explicit WindowPicture(const char* label);

  /// Draws `source` (CV_8UC3 BGR or CV_8UC4 BGRA, continuous, any size) into the middle of `where`, as large as it
  /// fits; `where` in px of the framebuffer that is bound for drawing, from its lower left corner. Does not present.
  void draw(const cv::Mat& source, const cv::Rect& where);

 private:
  const char* label_;
  cv::Size size_;
  gl::Texture texture_;
  gl::Framebuffer framebuffer_;
};

/// Clears the window's framebuffer, of `width` x `height` px, to the grey behind pictures, and binds it.
void begin_window(int width, int height);

}  // namespace foresight
