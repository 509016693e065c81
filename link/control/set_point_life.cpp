#include "link/control/set_point_life.hpp"

#include <algorithm>

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kSamples = 512;
constexpr Duration kWindow = 10s;
constexpr Duration kMeasureEvery = 250ms;
constexpr Duration kMargin = 80ms;  // some set-points that are lost in a row
constexpr double kNearlyAll = 0.98;

}  // namespace

SetPointLife::SetPointLife(SetPointLifeOptions options) : options_(options), life_(options.least) {
  samples_.reserve(kSamples);
  sorted_.reserve(kSamples);
}

void SetPointLife::forget() {
  samples_.clear();
  next_ = 0;
  measured_ = {};
  life_ = options_.least;
}

void SetPointLife::came(Duration age, RobotTime now) {
  if (samples_.size() < kSamples) {
    samples_.push_back({now, age});
  } else {
    samples_[next_] = {now, age};
    next_ = (next_ + 1) % kSamples;
  }
  if (now - measured_ >= kMeasureEvery) measure(now);
}

void SetPointLife::measure(RobotTime now) {
  measured_ = now;
  sorted_.clear();
  for (const Sample& s : samples_)
    if (now - s.at <= kWindow) sorted_.push_back(s.age);
  const auto rank = static_cast<std::size_t>(kNearlyAll * static_cast<double>(sorted_.size() - 1));
  std::nth_element(sorted_.begin(), sorted_.begin() + static_cast<std::ptrdiff_t>(rank), sorted_.end());
  const Duration most = sorted_[rank], least = *std::min_element(sorted_.begin(), sorted_.end());
  const Duration spread = std::min(most - least, options_.most_spread);
  const Duration allowed = std::clamp(least, Duration{0}, options_.allowed_delay);
  life_ = std::clamp(most + kMargin, options_.least, options_.widest + spread + allowed);
}

}  // namespace foresight
