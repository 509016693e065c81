// What is printed on things that come from files without a picture.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>

namespace foresight::sim::prints {

/// A square of `side` metres as sim/lab_prints.hpp has them: the label, seams, screws, scales and small print on
/// painted metal, the colours by the thing's number. Every 3 cm of it have something that a texture shows.
cv::Mat thing(double side, double texel, const std::string& label, std::size_t number, std::uint32_t seed);

}  // namespace foresight::sim::prints
