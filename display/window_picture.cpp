#include "display/window_picture.hpp"

#include <algorithm>

namespace foresight {

WindowPicture::WindowPicture(const char* label) : label_(label), framebuffer_(gl::create_framebuffer(label)) {}

void WindowPicture::draw(const cv::Mat& source, const cv::Rect& where) {
  if (source.size() != size_) {
    texture_ = gl::Texture(GL_RGBA8, source.cols, source.rows, 0, 1, label_);
    glNamedFramebufferTexture(framebuffer_.name(), GL_COLOR_ATTACHMENT0, texture_.name(), 0);
    size_ = source.size();
  }
  glTextureSubImage2D(texture_.name(), 0, 0, 0, source.cols, source.rows, source.channels() == 4 ? GL_BGRA : GL_BGR,
                      GL_UNSIGNED_BYTE, source.data);
  const double scale =
      std::min(where.width / static_cast<double>(source.cols), where.height / static_cast<double>(source.rows));
  const int w = std::max(1, static_cast<int>(source.cols * scale)),
            h = std::max(1, static_cast<int>(source.rows * scale));
  const int x = where.x + (where.width - w) / 2, y = where.y + (where.height - h) / 2;
  // Rows of a picture run downwards, those of a window upwards.
  glBlitNamedFramebuffer(framebuffer_.name(), 0, 0, 0, source.cols, source.rows, x, y + h, x + w, y,
                         GL_COLOR_BUFFER_BIT, GL_LINEAR);
}

void begin_window(int width, int height) {
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, width, height);
  glClearColor(0.12f, 0.13f, 0.15f, 1.0f);
  glClear(GL_COLOR_BUFFER_BIT);
}

}  // namespace foresight
