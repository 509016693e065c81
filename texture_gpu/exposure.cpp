#include "texture_gpu/exposure.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "common/statistics.hpp"

namespace foresight {
namespace {

constexpr std::size_t kFewestSamples = 30;
constexpr std::int64_t kReferenceAge = 30;  // images; long enough for pages to cross the picture
constexpr double kLargestLogGain = 6;       // a factor of 400: from a dark image's noise to a flash
constexpr float kDarkest = 0.04f;           // below, noise and black level rule the ratio
constexpr float kLeast = 0.5f / 255;        // what a value of 0 may be
constexpr double kSurelyBrighter = 0.75;    // quantile of the least ratios, where white pages are most
constexpr double kSameSurface = 0.2;        // a page's brightness changes by more: log of the factor
constexpr int kMostImages = 100;            // that a reference is the mean of
constexpr double kForgetting = 0.995;       // per image

/// Where responses are closest to a power law: below, black level and toe, above, the bend to white.
bool middle(double brightness) {
  return brightness >= 0.1 && brightness <= 0.75;
}

}  // namespace

void ExposureEstimator::update(std::span<const ExposureSample> samples, std::span<AtlasPage* const> pages,
                               std::int64_t image) {
  if (rough_) log_gain_ = steady_;  // the last image told only where the gain was not
  rough_ = false;
  std::vector<double> ratios, middle_ratios, at_least, dark;
  std::vector<std::size_t> used;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples[i].brightness < 0 || !pages[i] || pages[i]->exposure.image < 0) continue;
    const PageExposure& ref = pages[i]->exposure;
    const bool white = samples[i].white();
    const float brightness = white ? samples[i].brightness - ExposureSample::kWhite : samples[i].brightness;
    const double ratio = std::log(std::max(brightness, kLeast)) - vignetting_log(samples[i].radius2) - surface_log(ref);
    (white ? at_least : brightness < kDarkest ? dark : ratios).push_back(ratio);
    if (!white && middle(brightness) && middle(std::exp(ref.log_brightness))) middle_ratios.push_back(ratio);
    if (!white && brightness >= kDarkest) used.push_back(i);
  }
  ever_measured_ = ever_measured_ || ratios.size() >= kFewestSamples;
  measured_ = !ever_measured_ || ratios.size() >= kFewestSamples;
  if (ratios.size() >= kFewestSamples) {
    const double gain = median(middle_ratios.size() >= kFewestSamples ? middle_ratios : ratios);
    std::vector<double> deviations = ratios;
    for (double& d : deviations) d = std::abs(d - gain);
    const double sigma = std::max(0.005, 1.4826 * median(deviations));
    log_gain_ = std::clamp(gain, -kLargestLogGain, kLargestLogGain);
    std::vector<Eigen::Vector3d> rows;  // x1, x2, residual without any vignetting
    for (std::size_t k = 0; k < used.size(); ++k) {
      const ExposureSample& s = samples[used[k]];
      const PageExposure& ref = pages[used[k]]->exposure;
      const double r = s.radius2, residual = std::log(s.brightness) - ref.log_surface - log_gain_;
      if (std::abs(ratios[k] - gain) < 3 * sigma) rows.emplace_back(r - ref.radius2, r * r - ref.radius4, residual);
    }
    learn_vignetting(rows, sigma);
  } else if (at_least.size() + dark.size() >= kFewestSamples) {
    // A flash or a covered lens: what it shows must not pass for the surfaces' own brightness. A rough
    // gain is enough, as white and black texels do not replace older ones that agree (extract.comp).
    steady_ = log_gain_;
    rough_ = true;
    if (at_least.size() > dark.size())
      log_gain_ = std::clamp(quantile(at_least, kSurelyBrighter), log_gain_, kLargestLogGain);
    else
      log_gain_ = std::clamp(median(dark), -kLargestLogGain, log_gain_);
    return;
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples[i].brightness < kDarkest || samples[i].white() || !pages[i]) continue;
    PageExposure& ref = pages[i]->exposure;
    // References of bright pages would hand on what the bend of the response does to them.
    const bool better = middle(samples[i].brightness), good = middle(std::exp(ref.log_brightness));
    const bool old = ref.rough || image - ref.image >= kReferenceAge;
    if (ref.image >= 0 && !(better ? old || !good : old && !good)) continue;
    renew(ref, samples[i], image);
  }
}

/// The mean of what was seen of the page so far: replaced each time, the references of all pages would walk away
/// together. Where the page looks otherwise than before, something else lies there now.
void ExposureEstimator::renew(PageExposure& ref, const ExposureSample& sample, std::int64_t image) const {
  const double r2 = sample.radius2, log_brightness = std::log(sample.brightness);
  const double surface = log_brightness - log_gain_;
  const bool same =
      ref.image >= 0 && !ref.rough && std::abs(surface - vignetting_log(r2) - surface_log(ref)) < kSameSurface;
  ref.count = same ? std::min(ref.count + 1, kMostImages) : 1;
  const auto mean = [&](float& value, double now) {
    value = static_cast<float>(same ? value + (now - value) / ref.count : now);
  };
  mean(ref.log_surface, surface);
  mean(ref.radius2, r2);
  mean(ref.radius4, r2 * r2);
  ref.log_brightness = static_cast<float>(log_brightness);
  ref.image = image;
  ref.rough = false;
}

/// Least squares over all images, each with its own mean taken out: the mean is the gain's.
void ExposureEstimator::learn_vignetting(const std::vector<Eigen::Vector3d>& rows, double sigma) {
  if (rows.size() < kFewestSamples) return;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& row : rows) mean += row / static_cast<double>(rows.size());
  information_ *= kForgetting;
  moment_ *= kForgetting;
  const double weight = 1 / (sigma * sigma);
  for (const auto& row : rows) {
    const Eigen::Vector3d d = row - mean;
    information_ += weight * d.head<2>() * d.head<2>().transpose();
    moment_ += weight * d.head<2>() * d.z();
  }
  // Pages are not independent of each other; a tenth of the information is a safe claim.
  const Eigen::Matrix2d covariance = (0.1 * information_ + 1e-6 * Eigen::Matrix2d::Identity()).inverse();
  const Eigen::Vector2d solution = covariance * (0.1 * moment_);
  const Eigen::Vector2d at_corner(1, 1);
  const double value = at_corner.dot(solution), deviation = std::sqrt(at_corner.dot(covariance * at_corner));
  const bool trusted = std::abs(value) > 3 * deviation && std::abs(value) < 2;
  applied_ = trusted ? solution : Eigen::Vector2d::Zero();
}

}  // namespace foresight
