// From light on the sensor to the camera's 8-bit values.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace foresight::sim {

struct Sensor {
  /// Point spread of lens and demosaicing, standard deviation in px. With the pixels' own area 0.6
  /// leaves a tenth of the contrast at the Nyquist frequency, as usual colour cameras do.
  double blur = 0.6;
  double noise = 0;           ///< standard deviation at mid grey (128), in 8-bit values; shot and read noise
  double vignetting = 0;      ///< share of the light that the corners of the image lose, 0 .. 1; grows with r^2
  double exposure = 1;        ///< factor on the light: 1 as the lab is lit for, above 2 large parts are white
  double exposure_drift = 0;  ///< the exposure swings by this share up and down, 0 .. 1
  unsigned seed = 1;          ///< of the noise

  static constexpr double kDriftPeriod = 6;  ///< seconds

  /// Factor on the light at `t` seconds; `exposure` at t = 0.
  double gain(double t) const;

  /// Share of the light that arrives at pixel (u, v) of an image of this size.
  double falloff(double u, double v, cv::Size size) const;

  /// CV_32FC3 linear RGB to CV_8UC3 BGR sRGB with a soft shoulder. The noise is that of image
  /// `number`, the same each time. `factor`: on the light, besides gain(t). One thread.
  cv::Mat develop(const cv::Mat& light, double t, std::uint64_t number, double factor = 1) const;
};

/// The response without noise: linear light to an 8-bit value.
std::uint8_t encode(float light);

}  // namespace foresight::sim
