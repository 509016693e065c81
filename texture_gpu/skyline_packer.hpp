// Lays rectangles side by side.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <vector>

namespace foresight {

/// Corners of rectangles of the given sizes in a square of side `most`: the highest first, each as
/// low as the upper edge of those before it allows (bottom-left skyline: Burke et al. 2004, doi
/// 10.1287/opre.1040.0109). `used` becomes the extent that they take: the smallest of
/// those tried, from about square to four times as wide as high. Nothing where
/// they do not fit. Deterministic.
std::optional<std::vector<cv::Point>> pack_skyline(std::span<const cv::Size> sizes, int most, cv::Size& used);

}  // namespace foresight
