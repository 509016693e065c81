// What the figures show: images, polygons and details in which a step's effect is large.
#pragma once

#include "apps/bench/figure_lab.hpp"

namespace foresight {

/// Two images of a run: textures are extracted from the one and seen from the pose of the other.
struct FigurePair {
  std::size_t from = 0, to = 0;
};

/// The pair where most of what an object hid in the first image is seen in the second, and little
/// of it lies beyond the first one's border. Throws InputError where nothing hides anything.
FigurePair choose_pair(const FigureLab& lab);

/// The polygon with the most texels both seen and hidden by something else in `image`. Throws
/// InputError where there is none.
std::size_t choose_half_hidden(const FigureLab& lab, FigureTextures& textures, const PosedImage& image);

/// The polygon whose texture has the largest holes with colours of many kinds all around. Throws
/// InputError where no texture has a hole.
std::size_t choose_texture_with_holes(const FigureTextures& textures);

/// The direction of misregistered() that leaves the most wrong colours that an expansion removes.
int choose_direction(const FigureLab& lab, const FigurePair& pair, double mean_px);

/// Wrong colours of `raw` (255): unlike the actual image, no colours any more in `cleaned`, and beside a
/// wide hole, if there are such.
cv::Mat removed_errors(const cv::Mat& raw, const cv::Mat& cleaned, const cv::Mat& actual);

/// Wrong colours of `raw` (255) that are right, or nearly, in `better`.
cv::Mat mended_errors(const cv::Mat& raw, const cv::Mat& better, const cv::Mat& actual);

/// Where the two views (CV_8UC4) differ clearly (255), in colour or in having one.
cv::Mat differences(const cv::Mat& a, const cv::Mat& b);

inline constexpr int kDetailFactor = 4;

/// The window of 1 / factor of the image's width and height (whole pixels) that holds most of `mask`.
cv::Rect choose_detail(const cv::Mat& mask, int factor = kDetailFactor);

/// CV_8UC3 of an image of a run.
cv::Mat as_colour(const cv::Mat& pixels);

}  // namespace foresight
