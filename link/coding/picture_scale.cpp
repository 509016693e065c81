#include "link/coding/picture_scale.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace foresight {
namespace {

constexpr int kPlace = 16;      // px of a place's side
constexpr double kChanged = 2;  // grey levels of a place's mean; a sensor's noise changes that by a tenth of one
constexpr double kSmoothing = 0.2;
// Bytes per place that moves, below which halved pictures are nearer to the source, and above which whole ones are:
// measured with pairs of the synthetic lab, 10 to 30 a second.
constexpr double kHalveBelow = 2.0, kWholeAbove = 3.6;
constexpr int kHalveAfter = 3, kWholeAfter = 15;  // pairs

}  // namespace

double PictureScale::changed(const Planes& planes) {
  const cv::Mat luma(planes.size, CV_8UC1, const_cast<std::uint8_t*>(planes.y()));
  const cv::Size places(std::max(1, planes.size.width / kPlace), std::max(1, planes.size.height / kPlace));
  cv::Mat now;
  cv::resize(luma, now, places, 0, 0, cv::INTER_AREA);
  double share = 1;
  if (seen_.size() == now.size()) {
    cv::Mat difference;
    cv::absdiff(now, seen_, difference);
    share = cv::countNonZero(difference >= kChanged) / static_cast<double>(now.total());
  }
  seen_ = now;
  return share;
}

bool PictureScale::halved(const Planes& planes, std::size_t bytes) {
  moving_ += kSmoothing * (changed(planes) - moving_);
  const double places = static_cast<double>(planes.size.area()) / (kPlace * kPlace);
  const double per_place = static_cast<double>(bytes) / std::max(1.0, places * moving_);
  const bool other = halved_ ? per_place > kWholeAbove : per_place < kHalveBelow;
  for_change_ = other ? for_change_ + 1 : 0;
  if (for_change_ >= (halved_ ? kWholeAfter : kHalveAfter)) {
    halved_ = !halved_;
    for_change_ = 0;
  }
  return halved_;
}

}  // namespace foresight
