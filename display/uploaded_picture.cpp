#include "display/uploaded_picture.hpp"

#include <array>

namespace foresight {

void UploadedPicture::upload(const cv::Mat& source) {
  cv::Mat colour = source;
  // Copies from one framebuffer to another follow no swizzle, so grey goes up in all three channels.
  if (source.channels() == 1) cv::merge(std::array<cv::Mat, 3>{source, source, source}, colour);
  if (!texture_ || colour.cols != texture_.width() || colour.rows != texture_.height())
    texture_ = gl::Texture(GL_RGBA8, colour.cols, colour.rows, 0, 1, label_);
  glTextureSubImage2D(texture_.name(), 0, 0, 0, colour.cols, colour.rows, colour.channels() == 4 ? GL_BGRA : GL_BGR,
                      GL_UNSIGNED_BYTE, colour.data);
}

}  // namespace foresight
