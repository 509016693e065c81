#include "texture_gpu/slice_budget.hpp"

#include <algorithm>
#include <cmath>

#include "common/statistics.hpp"

namespace foresight {
namespace {

constexpr std::size_t kCosts = 16;
constexpr double kQuantile = 0.8;     // one preempted slice does not count
constexpr double kMostOwedNs = 50e6;  // a slice that takes longer comes to its turn with it, and pays afterwards
constexpr double kMostDebtNs = 200e6;
constexpr double kUrgentNs = 20e6;       // owed: slices run even while a frame is drawn
constexpr std::int64_t kLeastParts = 3;  // of a slice: less than one of them is not begun before a frame

}  // namespace

void SliceBudget::frame_begins(RobotTime now) {
  drawing_since_ = now;
}

void SliceBudget::frame_ends(RobotTime /*now*/, RobotTime next) {
  drawing_since_.reset();
  due_ = next;
}

Duration SliceBudget::expected(const std::string& kind, double units) const {
  const auto known = costs_.find(kind);
  return known == costs_.end() ? Duration{0} : Duration{std::llround(known->second.longest_ns * units)};
}

std::optional<RobotTime> SliceBudget::wait(RobotTime now, const std::string& kind, double units) {
  const Duration cost = expected(kind, units);
  if (waiting_since_) owed_ns_ += options_.least_share * static_cast<double>((now - *waiting_since_).count());
  owed_ns_ = std::min(owed_ns_, kMostOwedNs);
  waiting_since_ = now;
  const auto may_run = [&]() -> std::optional<RobotTime> {
    waiting_since_.reset();
    return std::nullopt;
  };
  if (drawing_since_) {
    const RobotTime limit = *drawing_since_ + options_.longest_frame;
    if (now >= limit || owed_ns_ >= kUrgentNs) return may_run();
    return std::min(limit, now + Duration{1 + std::llround((kUrgentNs - owed_ns_) / options_.least_share)});
  }
  if (!due_ || now > *due_ + options_.longest_frame) return may_run();
  if (now + cost <= *due_) return may_run();
  const double missing = std::min(static_cast<double>(cost.count()), kMostOwedNs) - owed_ns_;
  if (missing <= 0) return may_run();
  return now + Duration{std::max<std::int64_t>(1, std::llround(missing / options_.least_share))};
}

void SliceBudget::ran(RobotTime begin, RobotTime end, const std::string& kind, double units) {
  const double took = static_cast<double>((end - begin).count());
  owed_ns_ = std::max(owed_ns_ - (1 - options_.least_share) * took, took > kMostOwedNs ? -kMostDebtNs : 0.0);
  Costs& costs = costs_[kind];
  const double unit = std::max(0.0, took) / std::max(units, 1.0);
  if (costs.ns.size() < kCosts)
    costs.ns.push_back(unit);
  else
    costs.ns[costs.next] = unit;
  costs.next = (costs.next + 1) % kCosts;
  costs.longest_ns = quantile(costs.ns, kQuantile);
}

double SliceBudget::units_now(RobotTime now, Duration slice, const std::string& kind, double units) const {
  const Duration left = due_ && !drawing_since_ ? *due_ - now : slice;
  return units_within(left >= slice / kLeastParts ? std::min(left, slice) : slice, kind, units);
}

double SliceBudget::units_within(Duration time, const std::string& kind, double units) const {
  const auto known = costs_.find(kind);
  if (known == costs_.end() || known->second.longest_ns <= 0) return units;
  return std::clamp(std::floor(static_cast<double>(time.count()) / known->second.longest_ns), 1.0,
                    std::max(1.0, units));
}

}  // namespace foresight
