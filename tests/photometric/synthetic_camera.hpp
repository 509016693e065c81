// A camera with known response and vignetting: noise, 8 bits, saturation.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "calibration/photometric/exposure_series.hpp"

namespace foresight {

inline double srgb(double e) {
  return e <= 0.0031308 ? 12.92 * e : 1.055 * std::pow(e, 1 / 2.4) - 0.055;
}
inline double srgb_inverse(double v) {
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

struct SyntheticCamera {
  std::function<double(double)> response = srgb;  ///< exposure 0..1 to level 0..1
  std::array<double, 3> vignetting{-0.35, 0.12, -0.05};
  double noise = 1.2;  ///< grey levels
  double gain = 1;

  double vignette(double r2) const { return 1 + r2 * (vignetting[0] + r2 * (vignetting[1] + r2 * vignetting[2])); }

  cv::Mat picture(const cv::Mat& radiance, double exposure, std::mt19937& random) const {
    std::normal_distribution<double> normal(0, noise);
    cv::Mat out(radiance.size(), CV_8U);
    const Eigen::Vector2d centre((radiance.cols - 1) / 2.0, (radiance.rows - 1) / 2.0);
    const double half_2 = (radiance.cols * double(radiance.cols) + radiance.rows * double(radiance.rows)) / 4;
    for (int y = 0; y < out.rows; ++y)
      for (int x = 0; x < out.cols; ++x) {
        const double r2 = (Eigen::Vector2d(x, y) - centre).squaredNorm() / half_2;
        const double e = gain * exposure * radiance.at<double>(y, x) * vignette(r2);
        const double level = 255 * response(std::min(e, 1.0)) + normal(random);
        out.at<uchar>(y, x) = static_cast<uchar>(std::clamp(std::round(level), 0.0, 255.0));
      }
    return out;
  }
};

/// Smooth hills of light, 0.02 to 1.
inline cv::Mat hills(int width, int height) {
  cv::Mat out(height, width, CV_64F);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      out.at<double>(y, x) = std::exp(-2 + 1.9 * std::sin(0.021 * x + 0.5) * std::cos(0.017 * y));
  return out;
}

inline std::vector<ExposedImage> series_of(const SyntheticCamera& camera, const cv::Mat& radiance,
                                           const std::vector<double>& exposures, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<ExposedImage> series;
  for (const double t : exposures)
    series.push_back({"image" + std::to_string(series.size()) + ".png", t, camera.picture(radiance, t, random)});
  return series;
}

}  // namespace foresight
