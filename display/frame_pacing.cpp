#include "display/frame_pacing.hpp"

#include <algorithm>
#include <cmath>

#include "common/statistics.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kCosts = 64;                                // drawings that the quantile is taken of
constexpr std::size_t kSwaps = 16;                                // that are looked at together
constexpr std::uint64_t kProbeAgain = 1200;                       // frames
constexpr Duration kWaits = 300us;                                // a swap that takes less has not waited for a display
constexpr double kShortestRefresh = 2e6, kLongestRefresh = 60e6;  // ns
constexpr double kFast = 0.1, kSlow = 0.01;  // gains of phase and period: noise of 0.3 ms moves a target by 0.05 ms
constexpr double kDrift = 0.02;              // of the period that was found: beyond, it is another one

double ns(Duration d) {
  return static_cast<double>(d.count());
}
Duration rounded(double nanoseconds) {
  return Duration{std::llround(nanoseconds)};
}

/// Instants, ns, lie whole refreshes apart: of how many ns, by the `step` apart that is `parts` of them? One of them
/// that is late counts for no more than its place (Theil-Sen, https://en.wikipedia.org/wiki/Theil-Sen_estimator). 0:
/// no.
double refresh_of(const std::vector<double>& ends, double step, double parts) {
  double refresh = step / parts;
  if (refresh < kShortestRefresh || refresh > kLongestRefresh) return 0;
  std::vector<double> off;
  for (int round = 0; round < 2; ++round) {
    std::vector<double> counted{0}, slopes;  // refreshes since the first
    for (std::size_t i = 1; i < ends.size(); ++i)
      counted.push_back(std::max(counted.back() + 1, std::round((ends[i] - ends[0]) / refresh)));
    for (std::size_t i = 0; i < ends.size(); ++i)
      for (std::size_t j = i + 1; j < ends.size(); ++j)
        slopes.push_back((ends[j] - ends[i]) / (counted[j] - counted[i]));
    refresh = median(slopes);
  }
  for (std::size_t i = 1; i < ends.size(); ++i) {
    const double apart = ends[i] - ends[i - 1];
    off.push_back(std::abs(apart - refresh * std::round(apart / refresh)));
  }
  return quantile(off, 0.75) < 0.06 * refresh ? refresh : 0;
}

}  // namespace

FramePacing::FramePacing(const FramePacingOptions& options, RobotTime now)
    : options_(options), interval_(rounded(1e9 / options.rate_hz)), wake_(now), target_(now), drawn_(now) {
  plan(now, Duration{0});
}

Duration FramePacing::expected_cost() const {
  return rounded(quantile(costs_, options_.quantile));
}

void FramePacing::drawn(RobotTime now) {
  drawn_ = now;
  figures_.last = std::max(Duration{0}, now - wake_);
  const double cost = ns(figures_.last);
  if (costs_.size() < kCosts)
    costs_.push_back(cost);
  else
    costs_[next_cost_] = cost;
  next_cost_ = (next_cost_ + 1) % kCosts;
}

void FramePacing::swapped(RobotTime now, Duration rest) {
  ++figures_.frames;
  const Duration tolerance = phase_ == PacingPhase::locked ? rounded(0.5 * refresh_ns_) : interval_ / 2;
  if (now > target_ + tolerance) ++figures_.late;
  learn({drawn_, now});
  plan(now, std::min(rest, std::max(interval_, expected_cost())));
}

Duration FramePacing::off_grid(RobotTime at) const {
  const double apart = ns(at - anchor_);
  return rounded(apart - refresh_ns_ * std::round(apart / refresh_ns_));
}

// The first instant that lies an interval after the last target and leaves time for the drawing, and for what waits.
void FramePacing::plan(RobotTime now, Duration rest) {
  const Duration cost = expected_cost() + options_.reserve;
  if (phase_ == PacingPhase::locked) {
    const double steps = std::max(1.0, std::round(ns(interval_) / refresh_ns_));
    const RobotTime wanted = target_ + rounded(steps * refresh_ns_);
    // A hair of slack: a target that the filter has moved by microseconds is still the same refresh.
    const RobotTime possible = now + rest + cost - rounded(0.1 * refresh_ns_);
    const double least = std::max(ns(wanted - anchor_) / refresh_ns_ - 0.5, ns(possible - anchor_) / refresh_ns_);
    RobotTime next = anchor_ + rounded(std::ceil(least) * refresh_ns_);
    target_ = std::max(next, target_ + Duration{1});
  } else {
    target_ = std::max(target_ + interval_, now + rest + cost);
  }
  Duration early{0};
  if (phase_ == PacingPhase::probing) early = interval_ * static_cast<std::int64_t>(swaps_.size() % 4) / 16;
  wake_ = std::max(now + rest, target_ - cost - early);
}

void FramePacing::learn(const Swap& swap) {
  if (phase_ == PacingPhase::locked) return follow(swap);
  swaps_.push_back(swap);
  ++unlocked_for_;
  if (swaps_.size() < kSwaps) return;
  look_for_display();
  swaps_.clear();
}

void FramePacing::look_for_display() {
  if (phase_ == PacingPhase::probing) {
    phase_ = PacingPhase::own_clock;
    unlocked_for_ = 0;
    probed_ = true;
    lock_to(swaps_);
    return;
  }
  std::vector<double> waits;
  for (const Swap& swap : swaps_) waits.push_back(ns(swap.end - swap.begin));
  if (median(waits) > ns(kWaits) && (!probed_ || unlocked_for_ > kProbeAgain)) phase_ = PacingPhase::probing;
}

// A display holds swaps until its own instants, whenever they begin; else they end when they are made to.
bool FramePacing::lock_to(const std::vector<Swap>& swaps) {
  std::vector<double> at, apart;
  for (const Swap& swap : swaps) at.push_back(ns(swap.end - swaps.front().end));
  for (std::size_t i = 1; i < at.size(); ++i) apart.push_back(at[i] - at[i - 1]);
  if (apart.empty() || *std::ranges::min_element(apart) <= 0) return false;
  // Not the shortest: one swap that is late makes the next distance shorter.
  const double step = quantile(apart, 0.2);
  double refresh = 0;
  for (double parts = 1; parts <= 4 && refresh == 0; ++parts) refresh = refresh_of(at, step, parts);
  if (refresh == 0) return false;
  refresh_ns_ = refresh;
  anchor_ = swaps.back().end;
  std::vector<double> begins, ends;
  for (const Swap& swap : swaps) ends.push_back(ns(off_grid(swap.end)));
  const double late = median(ends);
  anchor_ = anchor_ + rounded(late);
  for (double& end : ends) end = std::abs(end - late);
  for (const Swap& swap : swaps) begins.push_back(ns(off_grid(swap.begin)));
  const double middle = median(begins);
  for (double& begin : begins) begin = std::abs(begin - middle);
  if (quantile(begins, 0.75) < 3 * quantile(ends, 0.75)) return false;
  phase_ = PacingPhase::locked;
  found_ns_ = refresh;
  strayed_.clear();
  without_wait_ = 0;
  return true;
}

// Only a swap that waited tells when the display took it.
void FramePacing::follow(const Swap& swap) {
  if (swap.end - swap.begin < kWaits) {
    if (++without_wait_ > 4 * kSwaps) display_changed();
    return;
  }
  without_wait_ = 0;
  const double off = ns(off_grid(swap.end));
  const bool strays = std::abs(off) > 0.2 * refresh_ns_;
  strayed_.push_back(strays);
  if (strayed_.size() > kSwaps) strayed_.erase(strayed_.begin());
  if (std::ranges::count(strayed_, true) > static_cast<std::ptrdiff_t>(kSwaps / 4)) return display_changed();
  if (strays) return;
  anchor_ = anchor_ + rounded(refresh_ns_ * std::round(ns(swap.end - anchor_) / refresh_ns_) + kFast * off);
  refresh_ns_ = std::clamp(refresh_ns_ + kSlow * off, (1 - kDrift) * found_ns_, (1 + kDrift) * found_ns_);
}

void FramePacing::display_changed() {
  phase_ = PacingPhase::own_clock;
  swaps_.clear();
  strayed_.clear();
  probed_ = false;
  unlocked_for_ = 0;
  without_wait_ = 0;
}

PacingFigures FramePacing::figures() const {
  PacingFigures out = figures_;
  out.cost = expected_cost();
  out.phase = phase_;
  if (phase_ == PacingPhase::locked) out.refresh = rounded(refresh_ns_);
  return out;
}

}  // namespace foresight
