#include "texture_gpu/skyline_packer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace foresight {
namespace {

/// What is taken so far in a strip of some width: steps from left to right.
class Skyline {
 public:
  explicit Skyline(int width) : width_(width), steps_{{0, 0}} {}

  int height() const { return height_; }

  /// At most as wide as the strip.
  cv::Point place(const cv::Size& size) {
    std::size_t best = 0;
    int best_y = std::numeric_limits<int>::max();
    for (std::size_t i = 0; i < steps_.size() && steps_[i].x + size.width <= width_; ++i) {
      int y = 0;
      for (std::size_t k = i; k < steps_.size() && steps_[k].x < steps_[i].x + size.width; ++k)
        y = std::max(y, steps_[k].y);
      if (y < best_y) best_y = y, best = i;
    }
    const cv::Point corner(steps_[best].x, best_y);
    raise(best, corner.x + size.width, best_y + size.height);
    height_ = std::max(height_, best_y + size.height);
    return corner;
  }

 private:
  /// The steps from number `first` up to `end` become one of height `y`.
  void raise(std::size_t first, int end, int y) {
    std::size_t last = first;
    int y_after = 0;
    while (last < steps_.size() && steps_[last].x < end) y_after = steps_[last++].y;
    const bool all = last < steps_.size() ? steps_[last].x == end : end == width_;
    const auto at = steps_.begin() + static_cast<std::ptrdiff_t>(first);
    const int x = at->x;
    const auto rest = steps_.erase(at, steps_.begin() + static_cast<std::ptrdiff_t>(last));
    const auto next = all ? rest : steps_.insert(rest, {end, y_after});
    steps_.insert(next, {x, y});
  }

  int width_, height_ = 0;
  std::vector<cv::Point> steps_;  // left end and height; ends where the next begins
};

}  // namespace

std::optional<std::vector<cv::Point>> pack_skyline(std::span<const cv::Size> sizes, int most, cv::Size& used) {
  std::vector<std::size_t> order(sizes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return sizes[a].height != sizes[b].height ? sizes[a].height > sizes[b].height : sizes[a].width > sizes[b].width;
  });
  double area = 0;
  int widest = 1, highest = 1;
  for (const cv::Size& size : sizes) {
    area += static_cast<double>(size.width) * size.height;
    widest = std::max(widest, size.width);
    highest = std::max(highest, size.height);
  }
  if (std::max(widest, highest) > most || area > static_cast<double>(most) * most) return std::nullopt;
  std::optional<std::vector<cv::Point>> best;
  constexpr double kStep = 1.03;
  const double narrowest = std::max<double>(widest, std::sqrt(area));
  for (double side = narrowest; side < std::min<double>(2 * narrowest, kStep * most); side *= kStep) {
    const int width = std::min(static_cast<int>(std::ceil(side)), most);
    Skyline skyline(width);
    std::vector<cv::Point> corners(sizes.size());
    for (const std::size_t i : order) corners[i] = skyline.place(sizes[i]);
    const cv::Size extent(width, skyline.height());
    if (extent.height > most || (best && extent.area() >= used.area())) continue;
    best = std::move(corners);
    used = extent;
  }
  return best;
}

}  // namespace foresight
