// Comparison with pictures that were looked at once and then kept in tests/golden.
#pragma once

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <string>

namespace foresight {

/// What may differ between renderers: rounding everywhere, and pixels at edges that fall on the
/// other side of it.
struct GoldenTolerance {
  double mean = 0.5;    ///< mean absolute difference over all channels, of 255
  int step = 6;         ///< a pixel differs when any channel is off by more than this
  double share = 0.01;  ///< of pixels that may differ
};

/// Compares with tests/golden/`name`.png (8 bit, 1, 3 or 4 channels). Where they disagree, what was
/// made lies in the temporary folder. With FORESIGHT_UPDATE_GOLDEN=1 writes the file instead.
testing::AssertionResult matches_golden(const cv::Mat& made, const std::string& name,
                                        const GoldenTolerance& tolerance = {});

}  // namespace foresight
