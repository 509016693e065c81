#include "calibration/photometric/photometric_solver.hpp"

#include <ceres/autodiff_cost_function.h>
#include <ceres/covariance.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <algorithm>
#include <map>
#include <set>

#include "calibration/camera/minimise.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr std::size_t kFewest = 50;    // samples: more than three per knot
constexpr double kLargestRms = 4;      // grey levels; more is no noise
constexpr double kMostBrighter = 0.9;  // of all places; of a proper series it is all of them
constexpr double kSmallestExponent = 0.4, kLargestExponent = 4;
constexpr double kStartExponent = 2;  // between a linear and a gamma-coded camera
constexpr double kSmallestVignette = 0.02;

struct Unknowns {
  Response response = Response::power_law(kStartExponent);
  Vignetting vignetting;
  std::vector<double> log_radiance;
};

double slope_at(const Response& response, double level) {
  constexpr double kStep = 1e-4;
  return (log_response(response.log_slope.data(), level * (1 + kStep)) -
          log_response(response.log_slope.data(), level * (1 - kStep))) /
         (2 * kStep);
}

// Parameters: log slopes (kKnots), log radiance (1), vignetting (3).
struct LevelResidual {
  double level, log_exposure, r2, weight;

  template <typename T>
  bool operator()(const T* log_slope, const T* log_radiance, const T* a, T* residual) const {
    using std::log;
    T e = log_radiance[0] + log_exposure;
    if (r2 >= 0) {
      const T v = T(1) + r2 * (a[0] + r2 * (a[1] + r2 * a[2]));
      if (!(v > T(kSmallestVignette))) return false;
      e += log(v);
    }
    residual[0] = weight * (log_response(log_slope, level) - e);
    return true;
  }
};

struct SmoothnessResidual {
  double weight;

  template <typename T>
  bool operator()(const T* log_slope, T* residual) const {
    for (int k = 0; k + 1 < kKnots; ++k) residual[k] = weight * (log_slope[k + 1] - log_slope[k]);
    return true;
  }
};

// Every sample's radiance as the start's response has it.
void start_radiances(const std::vector<LevelSample>& samples, Unknowns& x) {
  std::vector<std::pair<double, int>> sums(x.log_radiance.size());
  for (const LevelSample& s : samples) {
    sums[static_cast<std::size_t>(s.radiance)].first += std::log(x.response.inverse(s.level) / s.exposure_s);
    ++sums[static_cast<std::size_t>(s.radiance)].second;
  }
  for (std::size_t i = 0; i < sums.size(); ++i)
    x.log_radiance[i] = sums[i].second ? sums[i].first / sums[i].second : NAN;
}

double residual_of(const LevelSample& s, const Unknowns& x) {
  const double e = x.log_radiance[static_cast<std::size_t>(s.radiance)] + std::log(s.exposure_s) +
                   (s.r2 >= 0 ? std::log(x.vignetting(s.r2)) : 0);
  return (log_response(x.response.log_slope.data(), s.level) - e) * s.level / slope_at(x.response, s.level);
}

class Fit {
 public:
  Fit(const std::vector<LevelSample>& samples, const PhotometricOptions& options, Unknowns& x)
      : samples_(samples), options_(options), x_(x) {}

  // Twice: the weights follow the slope of the response, which the first round finds.
  void run() {
    for (int round = 0; round < 2; ++round) {
      build();
      MinimiseOptions options;
      options.solver = ceres::SPARSE_SCHUR;
      for (double& radiance : x_.log_radiance) options.eliminated.push_back(&radiance);
      minimise_or_throw(*problem_, options, "the response", "check that the exposure times belong to the images");
    }
  }

  ceres::Problem& problem() { return *problem_; }

 private:
  void build() {
    problem_ = std::make_unique<ceres::Problem>();
    double* a = x_.vignetting.a.data();
    bool vignetted = false;
    for (const LevelSample& s : samples_) {
      const double weight = s.level / (slope_at(x_.response, s.level) * options_.sigma_level);
      problem_->AddResidualBlock(new ceres::AutoDiffCostFunction<LevelResidual, 1, kKnots, 1, 3>(
                                     new LevelResidual{s.level, std::log(s.exposure_s), s.r2, weight}),
                                 new ceres::HuberLoss(options_.huber), x_.response.log_slope.data(),
                                 &x_.log_radiance[static_cast<std::size_t>(s.radiance)], a);
      vignetted |= s.r2 >= 0;
    }
    problem_->AddResidualBlock(new ceres::AutoDiffCostFunction<SmoothnessResidual, kKnots - 1, kKnots>(
                                   new SmoothnessResidual{options_.smoothness}),
                               nullptr, x_.response.log_slope.data());
    if (!vignetted) problem_->SetParameterBlockConstant(a);
  }

  const std::vector<LevelSample>& samples_;
  const PhotometricOptions& options_;
  Unknowns& x_;
  std::unique_ptr<ceres::Problem> problem_;
};

void require_enough(const std::vector<LevelSample>& samples, const PhotometricOptions& options) {
  // Only light that is seen at several exposures says something about the curve.
  std::map<int, std::pair<double, double>> spans;
  for (const LevelSample& s : samples) {
    auto& [least, most] = spans.try_emplace(s.radiance, s.exposure_s, s.exposure_s).first->second;
    least = std::min(least, s.exposure_s);
    most = std::max(most, s.exposure_s);
  }
  double ratio = 1;
  for (const auto& [radiance, span] : spans) ratio = std::max(ratio, span.second / span.first);
  if (samples.size() < kFewest)
    throw InputError("exposure series", std::to_string(samples.size()) + " blocks are neither dark nor saturated",
                     "choose exposures that leave most of the image between 8 and 250");
  if (ratio == 1)
    throw InputError("exposure series", "one exposure only: the response cannot be told from the scene",
                     "give a series of a still scene, the longest exposure at least 8 times the shortest");
  if (ratio < options.least_exposure_ratio)
    throw InputError("exposure series",
                     "the longest exposure of what is seen twice is only " + readable(ratio, 2) + " times the shortest",
                     "give a series over a factor of 8 or more");
}

double held_out(const std::vector<LevelSample>& samples, const PhotometricOptions& options, std::size_t radiances) {
  std::set<int> images;
  for (const LevelSample& s : samples) images.insert(s.image);
  if (images.size() < 4) return NAN;  // a curve from two exposures is no test of one from three
  double sum = 0;
  int count = 0;
  for (const int image : images) {
    std::vector<LevelSample> rest, left_out;
    for (const LevelSample& s : samples) (s.image == image ? left_out : rest).push_back(s);
    try {
      require_enough(rest, options);
    } catch (const InputError&) {
      continue;
    }
    Unknowns x;
    x.log_radiance.resize(radiances);
    start_radiances(rest, x);
    Fit(rest, options, x).run();
    for (const LevelSample& s : left_out) {
      const double log_radiance = x.log_radiance[static_cast<std::size_t>(s.radiance)];
      if (!std::isfinite(log_radiance)) continue;
      const double predicted =
          x.response.level(s.exposure_s * std::exp(log_radiance) * (s.r2 >= 0 ? x.vignetting(s.r2) : 1));
      sum += (predicted - s.level) * (predicted - s.level);
      ++count;
    }
  }
  return count ? std::sqrt(sum / count) : NAN;
}

// Rows of d ln g(v) / d log_slope, by differences: g is smooth in them.
Eigen::VectorXd gradient(const Response& response, double level) {
  constexpr double kStep = 1e-5;
  Eigen::VectorXd out(kKnots);
  for (std::size_t k = 0; k < kKnots; ++k) {
    Response moved = response;
    moved.log_slope[k] += kStep;
    out[static_cast<Eigen::Index>(k)] =
        (log_response(moved.log_slope.data(), level) - log_response(response.log_slope.data(), level)) / kStep;
  }
  return out;
}

class Uncertainty {
 public:
  Uncertainty(ceres::Problem& problem, Unknowns& x, double scale, PhotometricSummary& summary)
      : problem_(problem), x_(x), scale_(scale), summary_(summary) {}

  // `flat`: indices of radiances that flat fields see.
  void fill(const std::set<int>& flat) {
    ceres::Covariance::Options options;
    options.algorithm_type = ceres::SPARSE_QR;
    ceres::Covariance covariance(options);
    double* slopes = x_.response.log_slope.data();
    std::vector<const double*> blocks{slopes};
    if (summary_.has_vignetting) blocks.push_back(x_.vignetting.a.data());
    for (const int i : flat) blocks.push_back(&x_.log_radiance[static_cast<std::size_t>(i)]);
    std::vector<std::pair<const double*, const double*>> pairs;
    for (const double* block : blocks) pairs.emplace_back(block, block);
    if (!covariance.Compute(pairs, &problem_)) {
      summary_.warnings.emplace_back(
          "the covariance cannot be computed: parts of the curve rest on the smoothness alone");
      return;
    }
    Eigen::Matrix<double, kKnots, kKnots, Eigen::RowMajor> of_slopes;
    covariance.GetCovarianceBlock(slopes, slopes, of_slopes.data());
    for (int v = 1; v < 256; ++v) {
      const Eigen::VectorXd j = gradient(x_.response, v);
      summary_.response_sigma[static_cast<std::size_t>(v)] = scale_ * std::sqrt(std::max(0.0, j.dot(of_slopes * j)));
    }
    if (summary_.has_vignetting) {
      Eigen::Matrix<double, 3, 3, Eigen::RowMajor> of_a;
      covariance.GetCovarianceBlock(x_.vignetting.a.data(), x_.vignetting.a.data(), of_a.data());
      summary_.corner_sigma = scale_ * std::sqrt(std::max(0.0, of_a.sum()));
    }
    summary_.log_radiance_sigma.assign(x_.log_radiance.size(), NAN);
    for (const int i : flat) {
      double variance = 0;
      const double* block = &x_.log_radiance[static_cast<std::size_t>(i)];
      covariance.GetCovarianceBlock(block, block, &variance);
      summary_.log_radiance_sigma[static_cast<std::size_t>(i)] = scale_ * std::sqrt(variance);
    }
  }

 private:
  ceres::Problem& problem_;
  Unknowns& x_;
  double scale_;
  PhotometricSummary& summary_;
};

// Share of the places that get brighter from the shortest to the longest exposure at which their level is known, of all
// whose exposures differ.
double brighter(const std::vector<LevelSample>& samples) {
  constexpr double kClearly = 1.05;  // of the level, for an exposure half as long again and more
  std::map<std::pair<int, double>, std::pair<const LevelSample*, const LevelSample*>> spans;  // by light and radius
  for (const LevelSample& s : samples) {
    auto& [least, most] = spans.try_emplace({s.radiance, s.r2}, &s, &s).first->second;
    if (s.exposure_s < least->exposure_s) least = &s;
    if (s.exposure_s > most->exposure_s) most = &s;
  }
  int grown = 0, all = 0;
  for (const auto& [place, span] : spans) {
    const auto& [least, most] = span;
    if (most->exposure_s < 1.5 * least->exposure_s) continue;
    ++all;
    grown += most->level > kClearly * least->level;
  }
  return all == 0 ? 1 : double(grown) / all;
}

void judge(const std::vector<LevelSample>& samples, PhotometricSummary& summary) {
  Verdict& verdict = summary.verdict;
  if (const double share = brighter(samples); share < kMostBrighter) {
    verdict.object("only " + readable(100 * share, 0) +
                       " % of the places are brighter at the longest exposure than at the shortest",
                   "switch automatic exposure and gain off, and check that each exposure time is that of its picture");
  } else if (summary.rms_levels > kLargestRms || 5 * summary.outliers > summary.samples) {
    verdict.object("the levels do not fit (" + readable(summary.rms_levels, 1) + " levels RMS, " +
                       counted(summary.outliers, "outlier") + " of " + std::to_string(summary.samples) + ")",
                   "check that nothing in the scene moved, that the light does not flicker, and the exposure times");
  }
  const double exponent = std::log(summary.response.inverse(200) / summary.response.inverse(40)) / std::log(5.0);
  if (!(exponent > kSmallestExponent && exponent < kLargestExponent))
    verdict.object("a response with exponent " + readable(exponent, 1) + " is no camera's (1 is linear, 2.2 usual)",
                   "check the exposure times");
  if (summary.held_out_levels > 2 * kLargestRms)
    verdict.object(
        "pictures that were left out are predicted to " + readable(summary.held_out_levels, 1) + " levels only",
        "take more exposures, each at most twice as long as the one before");
}

}  // namespace

PhotometricSummary solve_photometric(const std::vector<LevelSample>& samples, const PhotometricOptions& options) {
  require_enough(samples, options);
  std::size_t radiances = 0;
  std::set<int> flat;
  for (const LevelSample& s : samples) {
    radiances = std::max(radiances, static_cast<std::size_t>(s.radiance) + 1);
    if (s.r2 >= 0) flat.insert(s.radiance);
  }
  Unknowns x;
  x.log_radiance.resize(radiances);
  start_radiances(samples, x);
  Fit fit(samples, options, x);
  PhotometricSummary summary;
  try {
    fit.run();
  } catch (const RuntimeFailure& failure) {
    summary.samples = static_cast<int>(samples.size());
    summary.log_radiance.assign(radiances, NAN);
    summary.log_radiance_sigma = summary.log_radiance;
    summary.verdict.object(failure.what(), "check each picture's time, and that the camera kept it");
    return summary;
  }
  summary.has_vignetting = !flat.empty();
  double squares = 0;
  for (const LevelSample& s : samples) {
    const double r = residual_of(s, x);
    squares += std::min(r * r, std::pow(options.huber * options.sigma_level, 2));
    summary.outliers += std::abs(r) > options.huber * options.sigma_level;
  }
  summary.samples = static_cast<int>(samples.size());
  summary.rms_levels = std::sqrt(squares / static_cast<double>(samples.size()));
  Uncertainty(fit.problem(), x, summary.rms_levels / options.sigma_level, summary).fill(flat);
  summary.held_out_levels = NAN;
  try {
    if (options.held_out) summary.held_out_levels = held_out(samples, options, radiances);
  } catch (const RuntimeFailure& failure) {
    summary.verdict.object("without one of its pictures " + std::string(failure.what()),
                           "take more pictures, at exposures that differ by twice");
  }
  summary.response = x.response;
  summary.vignetting = x.vignetting;
  summary.log_radiance = x.log_radiance;
  judge(samples, summary);
  return summary;
}

}  // namespace foresight
