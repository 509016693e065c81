#include "display/stereogram/separations.hpp"

#include <algorithm>
#include <vector>

namespace foresight {
namespace {

constexpr double kOutliers = 0.01;    // share at either end
constexpr double kLeastRatio = 1.01;  // of far to near

}  // namespace

double StereogramDepth::separation(double nearness) const {
  const double z = depth_of_field * (inverted ? 1 - nearness : nearness);
  return eye_distance * (1 - z) / (2 - z);
}

DepthRange depth_range(const cv::Mat& inverse_distance) {
  std::vector<float> seen;
  for (int y = 0; y < inverse_distance.rows; ++y)
    std::copy_if(inverse_distance.ptr<float>(y), inverse_distance.ptr<float>(y) + inverse_distance.cols,
                 std::back_inserter(seen), [](float q) { return q > 0; });
  if (seen.empty()) return {};
  const auto at = [&](double share) {
    const auto place = seen.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(seen.size() - 1));
    std::nth_element(seen.begin(), place, seen.end());
    return static_cast<double>(*place);
  };
  DepthRange out{1 / at(1 - kOutliers), 1 / at(kOutliers)};
  if (out.far < kLeastRatio * out.near) out = {out.near / kLeastRatio, out.far * kLeastRatio};
  return out;
}

cv::Mat nearness(const cv::Mat& inverse_distance, const DepthRange& range) {
  const double farthest = 1 / range.far, step = 1 / (1 / range.near - farthest);
  cv::Mat out;
  inverse_distance.convertTo(out, CV_32F, step, -farthest * step);
  return cv::max(cv::min(out, 1), 0);
}

}  // namespace foresight
