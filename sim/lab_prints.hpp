// What is printed on the things in the lab: one picture per material.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace foresight::sim::prints {

/// Each returns a CV_8UC3 BGR sRGB picture with texels of `texel` metres; sizes in metres.
cv::Mat wood(double width, double height, double texel, std::uint32_t light, std::uint32_t dark, double plank,
             std::uint32_t seed);
cv::Mat plain(double width, double height, double texel, std::uint32_t colour, double roughness, std::uint32_t seed);
cv::Mat floor_tiles(double texel, std::uint32_t seed);  ///< 2 x 2
cv::Mat cutting_mat(double texel, std::uint32_t seed);  ///< 0.60 x 0.42
cv::Mat cardboard(double width, double height, double texel, bool label, std::uint32_t seed);
cv::Mat product_front(double texel, std::uint32_t seed);  ///< 0.12 x 0.21
cv::Mat product_side(double texel, std::uint32_t seed);   ///< 0.09 x 0.21
cv::Mat poster(double texel, std::uint32_t seed);         ///< 0.62 x 0.44
cv::Mat pegboard(double texel, std::uint32_t seed);       ///< 0.70 x 0.44
cv::Mat graph_paper(double texel, std::uint32_t seed);    ///< 0.21 x 0.297
cv::Mat can_wrap(double texel, double length, double height, std::uint32_t seed);
cv::Mat mug_wrap(double texel, double length, double height, std::uint32_t seed);
cv::Mat bottle_wrap(double texel, double length, double height, std::uint32_t seed);
cv::Mat book_spine(double width, double height, double texel, std::uint32_t colour, std::uint32_t seed);
cv::Mat letter_block(double size, double texel, std::uint32_t colour, char letter, std::uint32_t seed);

}  // namespace foresight::sim::prints
