#include "display/comparison_window.hpp"

#include <algorithm>

namespace foresight {
namespace {

constexpr int kGap = 6;  // px between the pictures

gl::Texture picture(int width, int height) {
  return gl::Texture(GL_RGBA8, width, height, 0, 1, "compared picture");
}

}  // namespace

ComparisonWindow::ComparisonWindow(int width, int height)
    : pictures_{picture(width, height), picture(width, height), picture(width, height)},
      framebuffer_(gl::create_framebuffer("compared pictures")) {}

void ComparisonWindow::draw(const gl::Window& window, const cv::Mat& delayed, const cv::Mat& predicted,
                            const cv::Mat& actual) {
  int width = 0, height = 0;
  window.framebuffer_size(width, height);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, width, height);
  glClearColor(0.12f, 0.13f, 0.15f, 1.0f);
  glClear(GL_COLOR_BUFFER_BIT);
  const std::array<const cv::Mat*, 3> sources{&delayed, &predicted, &actual};
  const int cell = (width - 4 * kGap) / 3;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const cv::Mat& source = *sources[i];
    const gl::Texture& texture = pictures_[i];
    glTextureSubImage2D(texture.name(), 0, 0, 0, source.cols, source.rows, source.channels() == 4 ? GL_BGRA : GL_BGR,
                        GL_UNSIGNED_BYTE, source.data);
    const double scale =
        std::min(static_cast<double>(cell) / source.cols, static_cast<double>(height - 2 * kGap) / source.rows);
    const int w = std::max(1, static_cast<int>(source.cols * scale)),
              h = std::max(1, static_cast<int>(source.rows * scale));
    const int x = kGap + static_cast<int>(i) * (cell + kGap) + (cell - w) / 2, y = (height - h) / 2;
    glNamedFramebufferTexture(framebuffer_.name(), GL_COLOR_ATTACHMENT0, texture.name(), 0);
    // Rows of a picture run downwards, those of a window upwards.
    glBlitNamedFramebuffer(framebuffer_.name(), 0, 0, 0, source.cols, source.rows, x, y + h, x + w, y,
                           GL_COLOR_BUFFER_BIT, GL_LINEAR);
  }
}

}  // namespace foresight
