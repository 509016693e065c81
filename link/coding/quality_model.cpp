#include "link/coding/quality_model.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {

QualityModel::QualityModel(Range range, double steps_per_halving, int step, double bytes)
    : range_(range), steps_per_halving_(steps_per_halving), at_zero_(std::log2(bytes) + step / steps_per_halving) {}

int QualityModel::step_for(std::size_t budget) const {
  const double halvings = at_zero_ - std::log2(std::max<double>(1, static_cast<double>(budget)));
  const double step = std::round(halvings * steps_per_halving_);
  return static_cast<int>(std::clamp(step, static_cast<double>(range_.finest), static_cast<double>(range_.coarsest)));
}

void QualityModel::learn(int step, std::size_t bytes) {
  at_zero_ = std::log2(std::max<double>(1, static_cast<double>(bytes))) + step / steps_per_halving_;
}

}  // namespace foresight
