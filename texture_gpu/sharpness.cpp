#include "texture_gpu/sharpness.hpp"

#include <algorithm>
#include <vector>

#include "common/statistics.hpp"

namespace foresight {
namespace {

constexpr std::size_t kFewest = 40;        // pages, of which a quarter makes a median
constexpr double kLeastContrast = 0.0004;  // (5 grey levels per px)^2: flatter pictures tell nothing
constexpr int kMemory = 10;                // images

}  // namespace

void SharpnessEstimator::update(std::span<const AgreementSample> samples) {
  std::vector<AgreementSample> told;
  std::ranges::copy_if(samples, std::back_inserter(told), [](const auto& s) { return s.difference2 >= 0; });
  if (told.size() < kFewest) return;
  std::ranges::sort(told, {}, &AgreementSample::gradient2);
  const auto middle = [](std::span<const AgreementSample> group, float AgreementSample::*of) {
    std::vector<double> values;
    for (const AgreementSample& sample : group) values.push_back(sample.*of);
    return median(values);
  };
  const std::size_t quarter = told.size() / 4;
  const auto flat = std::span(told).first(quarter), textured = std::span(told).last(quarter);
  const double contrast = middle(textured, &AgreementSample::gradient2) - middle(flat, &AgreementSample::gradient2);
  if (contrast < kLeastContrast) return;
  const double slope =
      (middle(textured, &AgreementSample::difference2) - middle(flat, &AgreementSample::difference2)) / contrast;
  images_ = std::min(images_ + 1, kMemory);
  misplacement2_ = misplacement2_.value_or(0) + (std::max(slope, 0.0) - misplacement2_.value_or(0)) / images_;
}

double SharpnessEstimator::cubic_share() const {
  return misplacement2_ ? std::clamp(1 - 6 * *misplacement2_, kLeast, kMost) : kMost;
}

}  // namespace foresight
