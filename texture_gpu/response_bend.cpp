#include "texture_gpu/response_bend.hpp"

#include <algorithm>

namespace foresight {
namespace {

constexpr double kForgetting = 0.99;    // per image
constexpr double kClearlyBetter = 0.8;  // of the misfit; a change is seen, so it must be worth it
constexpr double kLeastMisfit = 0.5;    // summed over images: the mean deviation from the gain, as a log
constexpr double kTelling = 0.1;        // least change of exposure that tells something, as a log

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

bool ResponseBend::update(std::span<const Pair> pairs, double log_gain) {
  std::vector<double> steps;
  for (const Pair& pair : pairs)
    if (std::abs(log_gain - pair.log_gain) > kTelling) steps.push_back(std::abs(log_gain - pair.log_gain));
  if (steps.size() < pairs.size() / 4 || steps.size() < 30) return false;

  std::array<double, kBends.size()> scale{};
  for (std::size_t k = 0; k < kBends.size(); ++k) {
    // A bend stretches all gains alike; that alone is no better fit.
    std::vector<double> factors;
    for (const Pair& p : pairs)
      if (std::abs(log_gain - p.log_gain) > kTelling)
        factors.push_back((log_light(p.now, kBends[k]) - log_light(p.then, kBends[k]) - p.vignetting) /
                          (log_gain - p.log_gain));
    const std::vector<double> in_order = factors;
    scale[k] = std::max(0.1, median(factors));
    // Pages whose exposure changed more tell more.
    double sum = 0, all = 0;
    for (std::size_t i = 0; i < steps.size(); ++i) {
      sum += steps[i] * std::min(std::abs(in_order[i] / scale[k] - 1), 1.0);
      all += steps[i];
    }
    misfit_[k] = kForgetting * misfit_[k] + sum / all;
  }
  const auto best = static_cast<std::size_t>(std::min_element(misfit_.begin(), misfit_.end()) - misfit_.begin());
  if (best == current_ || misfit_[current_] < kLeastMisfit || misfit_[best] > kClearlyBetter * misfit_[current_])
    return false;
  changes_.push_back({log_gain, scale[best] / scale[current_]});
  current_ = best;
  return true;
}

double ResponseBend::carried_over(double log_gain, std::uint32_t epoch) const {
  for (std::size_t i = epoch; i < changes_.size(); ++i)
    log_gain = changes_[i].log_gain + changes_[i].scale * (log_gain - changes_[i].log_gain);
  return log_gain;
}

}  // namespace foresight
