// By how much a picture's grey differs around a pixel, in steps that one number holds, whatever the picture's range.
#pragma once

#include <opencv2/core.hpp>

namespace foresight {

/// 4 steps each time that levels + 3 double; the last one is all from 37 levels on.
inline constexpr int kContrastSteps = 16;
/// The middle of a step, grey levels.
double contrast_levels(int step);

/// Steps, CV_8UC1: root of the mean square difference between a pixel and its eight neighbours, at rims the nearest
/// pixels in their place; as trust.comp has it. `grey`: CV_8UC1.
cv::Mat contrast_steps(const cv::Mat& grey);

}  // namespace foresight
