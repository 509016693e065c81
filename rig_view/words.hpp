// Words of a drawing, written into its picture where they do not cover each other.
#pragma once

#include <opencv2/core.hpp>

#include "rig_view/drawing.hpp"
#include "rig_view/eye.hpp"

namespace foresight {

inline cv::Scalar bgr(const Colour& c) {
  return {255.0 * static_cast<double>(c[2]), 255.0 * static_cast<double>(c[1]), 255.0 * static_cast<double>(c[0])};
}

/// `text` as it is where it has room within `width_px` (0: any) at `size`, else without its middle, as "the_joi..r_11".
/// One '?' for each letter that is not ASCII.
std::string fitting_text(const std::string& text, double size, int width_px, int weight = 1);

/// One line of text, its baseline's left end at `at`; where it would be wider than `width_px` (0: as it is) a little
/// smaller, then without its middle.
void put_text(cv::Mat& picture, const std::string& text, cv::Point at, double size, const cv::Scalar& colour,
              int width_px = 0, int weight = 1);

/// Each beside its place, moved where others stand already, with a thin line to its place; those whose place is not in
/// the picture are left out. How many were written.
std::size_t write_words(cv::Mat& picture, const std::vector<Drawing::Word>& words, const Eye& eye);

}  // namespace foresight
