#include "tests/thesis/texels.hpp"

#include <random>

namespace foresight {

void write_texels(const gl::Texture& texture, const cv::Mat& texels) {
  glTextureSubImage2D(texture.name(), 0, 0, 0, texels.cols, texels.rows, GL_RGBA, GL_UNSIGNED_BYTE, texels.data);
}

cv::Mat read_texels(const gl::Texture& texture, int width, int height) {
  cv::Mat texels(height, width, CV_8UC4);
  glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
  glGetTextureSubImage(texture.name(), 0, 0, 0, 0, width, height, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                       static_cast<GLsizei>(texels.total() * 4), texels.data);
  return texels;
}

cv::Mat blotted_texels(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  cv::Mat texels(height, width, CV_8UC4);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      texels.at<cv::Vec4b>(y, x) =
          cv::Vec4b(static_cast<uchar>(random()), static_cast<uchar>(random()), static_cast<uchar>(random()), 255);
  for (int blot = 0; blot < 5; ++blot) {
    const int x0 = static_cast<int>(random() % static_cast<unsigned>(width)),
              y0 = static_cast<int>(random() % static_cast<unsigned>(height)),
              size = 1 + static_cast<int>(random() % 9);
    for (int y = y0; y < std::min(height, y0 + size); ++y)
      for (int x = x0; x < std::min(width, x0 + size); ++x) texels.at<cv::Vec4b>(y, x)[3] = 0;
  }
  return texels;
}

}  // namespace foresight
