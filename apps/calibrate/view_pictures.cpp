#include "apps/calibrate/view_pictures.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <set>

#include "common/text.hpp"
#include "pictures/picture_file.hpp"

namespace foresight {
namespace {

constexpr int kWidth = 480;   // px
constexpr int kSubpixel = 3;  // bits of a drawn coordinate

const cv::Scalar kFound(70, 200, 60), kError(60, 60, 240);

}  // namespace

cv::Mat draw_view(const std::filesystem::path& file, std::span<const ShownPoint> points) {
  const cv::Mat whole = read_picture(file, PictureColours::colour);
  const double scale = kWidth / static_cast<double>(whole.cols);
  cv::Mat out;
  cv::resize(whole, out, {kWidth, static_cast<int>(scale * whole.rows + 0.5)}, 0, 0,
             scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
  const auto at = [&](const Eigen::Vector2d& pixel) {
    const Eigen::Vector2d p = (scale * (pixel.array() + 0.5) - 0.5) * (1 << kSubpixel);
    return cv::Point(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())));
  };
  for (const ShownPoint& point : points) {
    cv::circle(out, at(point.found), 3 << kSubpixel, kFound, 1, cv::LINE_AA, kSubpixel);
    if (!point.predicted.allFinite()) continue;
    const Eigen::Vector2d end = point.found + kArrow * (point.predicted - point.found);
    cv::line(out, at(point.found), at(end.cwiseMax(-1e4).cwiseMin(1e4)), kError, 1, cv::LINE_AA, kSubpixel);
  }
  return out;
}

std::vector<int> view_numbers(const std::vector<std::string>& names) {
  std::vector<int> numbers;
  std::set<int> different;
  for (const std::string& name : names) {
    const auto last = name.find_last_of("0123456789");
    if (last == std::string::npos) break;
    const auto before = name.find_last_not_of("0123456789", last);
    const auto first = before == std::string::npos ? 0 : before + 1;
    const auto number = parse_integer(std::string_view(name).substr(first, last + 1 - first));
    if (!number || *number > 1'000'000) break;
    numbers.push_back(static_cast<int>(*number));
    different.insert(numbers.back());
  }
  if (numbers.size() == names.size() && different.size() == names.size()) return numbers;
  numbers.clear();
  for (std::size_t i = 0; i < names.size(); ++i) numbers.push_back(static_cast<int>(i) + 1);
  return numbers;
}

std::vector<std::size_t> some_of(std::size_t count, std::size_t most) {
  std::vector<std::size_t> out;
  const std::size_t n = std::min(count, most);
  for (std::size_t i = 0; i < n; ++i) out.push_back(i * count / n);
  return out;
}

}  // namespace foresight
