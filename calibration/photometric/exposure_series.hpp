// Images at known exposure times, as samples for the photometric solver.
#pragma once

#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calibration/photometric/photometric_solver.hpp"

namespace foresight {

struct ExposedImage {
  std::string name;
  double exposure_s = 0;
  cv::Mat pixels;  ///< CV_8U, one channel or three
};

/// Rows "NAME SECONDS" (a fraction such as 1/60 is taken too), NAME a file name. Throws InputError
/// naming file and line.
std::map<std::string, double> read_exposures(const std::filesystem::path& file);

/// ExposureTime of a JPEG's EXIF data, in seconds; nothing where there is none.
std::optional<double> exif_exposure(const std::filesystem::path& file);

/// All images of a folder in the order of their names, with their exposure times from `exposures` (every image
/// must be named there) or, where that is empty, from EXIF. Throws InputError: no images, sizes that
/// differ, an image without an exposure time (with the nearest name).
std::vector<ExposedImage> read_series(const std::filesystem::path& folder,
                                      const std::map<std::string, double>& exposures);

/// Objects to pictures that are the same, pixel by pixel, though their exposure times differ, by name.
void judge_series(const std::vector<ExposedImage>& series, Verdict& verdict);

struct SeriesSamples {
  std::vector<LevelSample> samples;
  int images = 0;
  int radiances = 0;
  std::vector<int> flat_radiances;  ///< one per channel, of the flat field
  int saturated = 0;                ///< blocks dropped
  int dark = 0;
};

/// Appends blocks of a static scene: about `most` places, spread over the image and over the levels, where the
/// scene is smooth; each place and channel is a radiance of its own.
void add_static(const std::vector<ExposedImage>& series, int most, SeriesSamples& out);

/// Appends a grid of blocks of an evenly lit surface: one radiance per channel, radii from `centre` (px).
void add_flat(const std::vector<ExposedImage>& series, const Eigen::Vector2d& centre, SeriesSamples& out);

}  // namespace foresight
