#include "display/comparison_window.hpp"

namespace foresight {
namespace {

constexpr int kGap = 6;  // px between the pictures

}  // namespace

ComparisonWindow::ComparisonWindow()
    : pictures_{WindowPicture("delayed picture"), WindowPicture("predicted picture"), WindowPicture("actual picture")} {
}

void ComparisonWindow::draw(const gl::Window& window, const cv::Mat& delayed, const cv::Mat& predicted,
                            const cv::Mat& actual) {
  int width = 0, height = 0;
  window.framebuffer_size(width, height);
  begin_window(width, height);
  const std::array<const cv::Mat*, 3> sources{&delayed, &predicted, &actual};
  const int cell = (width - 4 * kGap) / 3;
  for (std::size_t i = 0; i < sources.size(); ++i)
    pictures_[i].draw(*sources[i], {kGap + static_cast<int>(i) * (cell + kGap), kGap, cell, height - 2 * kGap});
}

}  // namespace foresight
