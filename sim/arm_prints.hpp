// What is printed on the arm.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>

namespace foresight::sim::prints {

/// The cover of a link, `length` around and `height` along it, metres: a shell with a coloured
/// ring at its upper end, seams, screws, labels and marks. CV_8UC3 BGR sRGB, texels of `texel` metres.
cv::Mat arm_cover(double length, double height, double texel, const std::string& label, std::uint32_t ring,
                  std::uint32_t seed);

/// The ball around a joint, `length` around and `height` from its neck to its pole: seams, screws, dots, a scale.
cv::Mat arm_ball(double length, double height, double texel, std::uint32_t ring, std::uint32_t seed);

}  // namespace foresight::sim::prints
