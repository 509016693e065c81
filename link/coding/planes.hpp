// Pictures as video coders want them: luma and halved chroma (I420), both eyes in one, the right below the left.
#pragma once

#include <span>

#include "link/coding/coded_pair.hpp"

namespace foresight {

/// The size of one eye's part: sides are even, by a repeated last column or row.
cv::Size even_size(int width, int height);

/// One buffer of a picture of `size`: rows of Y, then of U, then of V.
struct Planes {
  cv::Size size;
  std::vector<std::uint8_t> bytes;

  std::uint8_t* y() { return bytes.data(); }
  std::uint8_t* u() { return y() + size.area(); }
  std::uint8_t* v() { return u() + size.area() / 4; }
  const std::uint8_t* y() const { return bytes.data(); }
};

/// BT.601, video range, as cv::COLOR_BGR2YUV_I420; grey pictures keep their full range and have no chroma.
Planes to_planes(const StereoPicture& picture);

/// Of pictures half as wide and high, rounded up; each pixel is the mean of what it covers.
StereoPicture halve(const StereoPicture& picture);
/// And back to `size`, smoothly.
StereoPicture enlarge(const StereoPicture& picture, cv::Size size);

/// Smooths all planes by a Gaussian of this standard deviation, in luma pixels; below a third of one not at all.
void soften(Planes& planes, double sigma);

/// Back again, into pictures of `width` x `height`.
StereoPicture from_planes(const Planes& planes, int width, int height, bool colour, bool stereo);

}  // namespace foresight
