// What depth a stereogram tells, found as eyes find it: by comparing each row with itself.
#pragma once

#include "display/stereogram/separations.hpp"

namespace foresight {

/// For each pixel of `picture` (CV_8UC3), how many px to its left the same is seen, `least` to `most`: CV_32F, to a
/// fraction of a pixel; 0 where there is not that much to the left. It knows nothing of what the picture was made from.
cv::Mat decode_stereogram(const cv::Mat& picture, double least, double most);

/// Of the points of a surface (nearness(), CV_32F) that both eyes can see inside of the picture, the share whose
/// separation was decoded within `tolerance` px. 0 where there are none.
double share_decoded(const cv::Mat& nearness, const cv::Mat& decoded, const StereogramDepth& depth, double tolerance);

}  // namespace foresight
