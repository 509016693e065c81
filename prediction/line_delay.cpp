#include "prediction/line_delay.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace foresight {
namespace {

constexpr double kMemory = 30;         // s
constexpr double kUsual = 0.005;       // s: after a few messages that far off the median, weights are learnt
constexpr double kLeast = 1e-5;        // s
constexpr double kLongestSilence = 1;  // s that forgetting counts for a silence

Weights two(double a, double b) {
  Weights w(2);
  w << a, b;
  return w;
}

}  // namespace

LineDelay::LineDelay(const LineDelayOptions& options)
    : options_(options),
      fit_(two(0, 0.5), two(kUsual * kUsual * 10, kUsual * kUsual * 10), kMemory),
      sigma_(0.02, kLeast, 2, CalibratedSigma::kScaleOfOne),
      inputs_(two(0, 0)) {}

bool LineDelay::add(double time, double delay) noexcept {
  if (!std::isfinite(time) || !(delay >= 0 && delay <= options_.largest)) return false;
  if (!delays_.empty()) {
    if (time < time_) return false;
    const double passed = std::min(time - time_, kLongestSilence);
    sigma_.score(std::abs(delay - expected_), sigma_.sigma(), passed);
    fit_.forget(passed);
    fit_.add(inputs_, delay - median_);
  }
  time_ = time;
  delays_.next() = delay;
  predict();
  return true;
}

void LineDelay::predict() noexcept {
  std::array<double, kMost> sorted{};
  const std::size_t count = delays_.size(), few = std::min(count, kFew);
  double recent = 0;
  for (std::size_t i = 0; i < count; ++i) {
    sorted[i] = delays_[i];
    if (i + few >= count) recent += delays_[i] / static_cast<double>(few);
  }
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(count));
  median_ = *middle;
  inputs_ = two(delays_.newest() - median_, recent - median_);
  expected_ = std::max(0.0, median_ + fit_.predict(inputs_));
}

PredictedDelay LineDelay::at(double time) const noexcept {
  if (delays_.empty() || !(time >= time_ && time - time_ <= options_.stale)) return {};
  return {expected_, sigma_.sigma(), true};
}

}  // namespace foresight
