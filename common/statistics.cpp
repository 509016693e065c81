#include "common/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace foresight {
namespace {

template <typename T>
T quantile_of(std::vector<T> values, double share) {
  if (values.empty()) return 0;
  const double rank = std::clamp(share, 0.0, 1.0) * static_cast<double>(values.size() - 1);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), at, values.end());
  const double part = rank - std::floor(rank);
  if (part == 0) return *at;
  return static_cast<T>(std::lerp(double{*at}, double{*std::min_element(at + 1, values.end())}, part));
}

}  // namespace

double quantile(std::vector<double> values, double share) {
  return quantile_of(std::move(values), share);
}

float quantile(std::vector<float> values, double share) {
  return quantile_of(std::move(values), share);
}

double median(std::vector<double> values) {
  return quantile_of(std::move(values), 0.5);
}

float median(std::vector<float> values) {
  return quantile_of(std::move(values), 0.5);
}

double robust_sigma(std::vector<double> values) {
  constexpr double kSigmaOfMedian = 1.4826;
  for (double& value : values) value = std::abs(value);
  return kSigmaOfMedian * median(std::move(values));
}

double robust_sigma_of_lengths(std::vector<double> lengths) {
  constexpr double kMedianLength = 1.1774100225154747;  // sqrt(2 log 2)
  return median(std::move(lengths)) / kMedianLength;
}

double root_mean_square(std::span<const double> values) {
  if (values.empty()) return 0;
  double sum = 0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

}  // namespace foresight
