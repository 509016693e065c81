// A map over an image as inline SVG: colours from dark (least) to yellow (most), a colour bar beside it.
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace foresight {

/// `values`: CV_64F, any size, its cells stretched over width x height px; what is not finite stays
/// empty. The bar runs from the least to the 98 % quantile, so that a corner does not darken the rest.
/// Throws std::invalid_argument: another type, no cell, no image.
std::string heat_map_svg(const std::string& label, const cv::Mat& values, int width, int height,
                         const std::string& unit);

}  // namespace foresight
