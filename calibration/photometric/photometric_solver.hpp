// Response and vignetting of one camera from grey levels at known exposure times.
#pragma once

#include <string>
#include <vector>

#include "calibration/photometric/response.hpp"
#include "calibration/result/verdict.hpp"

namespace foresight {

/// The mean level of a small block of pixels (of one channel) in one image.
struct LevelSample {
  int image = 0;          ///< counted from 0
  double exposure_s = 0;  ///< of the image, above 0
  int radiance = 0;       ///< index: samples of one index see the same light
  double r2 = -1;         ///< squared radius in half diagonals; below 0: no vignetting (a static scene's own block)
  double level = 0;       ///< grey levels, within kDarkest to kBrightest
};
inline constexpr double kDarkest = 8;      ///< below, quantisation and offsets rule
inline constexpr double kBrightest = 250;  ///< above, single pixels of a block may have saturated

struct PhotometricOptions {
  double sigma_level = 1;             ///< of a sample, grey levels: scales the robust loss
  double huber = 3;                   ///< in sigmas; pixels that moved or flicker
  double smoothness = 0.5;            ///< weight of slope differences; only matters for knots without samples
  double least_exposure_ratio = 1.5;  ///< longest over shortest; less does not show the curve
  bool held_out = true;               ///< leave-one-image-out, one solve per image
};

struct PhotometricSummary {
  Response response;
  std::array<double, 256> response_sigma{};  ///< relative, of g
  bool has_vignetting = false;
  Vignetting vignetting;
  double corner_sigma = 0;                 ///< of V(1)
  std::vector<double> log_radiance;        ///< of each index; NaN where no sample saw it
  std::vector<double> log_radiance_sigma;  ///< of those that flat fields see; else empty
  int samples = 0;
  int outliers = 0;            ///< beyond the robust loss's bend
  double rms_levels = 0;       ///< of the residuals, grey levels
  double held_out_levels = 0;  ///< RMS of the levels predicted for images that were left out; NaN: too few
  std::vector<std::string> warnings;
  Verdict verdict;
};

/// Residual of a sample, in grey levels over sigma: (ln g(v) - ln t - ln L - ln V) * v / n(v), with Huber's loss;
/// gauge: g(255) = 1. Solved by Ceres, starting at a power law. Throws InputError naming what is missing: one exposure
/// only, a ratio of exposures that is too small, too few samples. Where it does not converge, the verdict says so.
PhotometricSummary solve_photometric(const std::vector<LevelSample>& samples, const PhotometricOptions& options = {});

}  // namespace foresight
