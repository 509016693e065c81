// Small stereo pictures of something that moves, for tests of image coding: the same each time.
#pragma once

#include <opencv2/imgproc.hpp>

#include "link/coding/coded_pair.hpp"

namespace foresight {

/// A textured ground that slides, with a disc before it, and noise of `noise` 8-bit values.
inline StereoPicture moving_picture(RobotTime time, cv::Size size = {96, 64}, bool colour = true, double noise = 2) {
  const double t = to_seconds(time - RobotTime{});
  StereoPicture out{.captured = time};
  for (int eye = 0; eye < 2; ++eye) {
    cv::Mat picture(size, CV_8UC3);
    for (int v = 0; v < size.height; ++v)
      for (int u = 0; u < size.width; ++u) {
        const double x = u + 20 * t + 3 * eye, y = v + 8 * std::sin(t);
        picture.at<cv::Vec3b>(v, u) = {cv::saturate_cast<std::uint8_t>(120 + 60 * std::sin(x / 5) * std::cos(y / 7)),
                                       cv::saturate_cast<std::uint8_t>(110 + 50 * std::sin((x + y) / 9)),
                                       cv::saturate_cast<std::uint8_t>(130 + 40 * std::cos(x / 3))};
      }
    const cv::Point2d disc(size.width * (0.5 + 0.3 * std::sin(2 * t)), size.height * (0.5 + 0.3 * std::cos(3 * t)));
    cv::circle(picture, disc, size.height / 6, {30, 200, 240}, cv::FILLED);
    cv::Mat grain(size, CV_16SC3);
    cv::RNG random(static_cast<std::uint64_t>(time.ns) * 2 + static_cast<std::uint64_t>(eye) + 1);
    random.fill(grain, cv::RNG::NORMAL, 0, noise);
    cv::add(picture, grain, picture, cv::noArray(), CV_8UC3);
    if (!colour) cv::cvtColor(picture, picture, cv::COLOR_BGR2GRAY);
    (eye == 0 ? out.left : out.right) = picture;
  }
  return out;
}

}  // namespace foresight
