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
constexpr double kMostSpareNs = 25e6;    // owed less: what it has had beyond its share
constexpr double kUrgentNs = 20e6;       // owed: slices run even while a frame is drawn
constexpr std::int64_t kLeastParts = 3;  // of a slice: less than one of them is not begun before a frame

/// Owed, ns, at which a slice that costs so much comes to its turn.
double turn_of(Duration cost) {
  return std::min(static_cast<double>(cost.count()), kMostOwedNs);
}

}  // namespace

void SliceBudget::frame_begins(RobotTime now, FramesOf display) {
  frames_[static_cast<std::size_t>(display)].drawing_since = now;
}

void SliceBudget::frame_ends(RobotTime /*now*/, RobotTime next, FramesOf display) {
  frames_[static_cast<std::size_t>(display)] = {std::nullopt, next};
}

SliceBudget::Ahead SliceBudget::ahead(RobotTime now) const {
  Ahead out;
  for (const Frames& frames : frames_) {
    if (frames.drawing_since) {
      const RobotTime limit = *frames.drawing_since + options_.longest_frame;
      if (now < limit) out.drawn_until = std::max(out.drawn_until.value_or(limit), limit);
    } else if (frames.due && now <= *frames.due + options_.longest_frame) {
      out.due = std::min(out.due.value_or(*frames.due), *frames.due);
    }
  }
  return out;
}

double SliceBudget::owed_ns(RobotTime now) const {
  const double since = waiting_since_ ? options_.least_share * static_cast<double>((now - *waiting_since_).count()) : 0;
  return std::min(owed_ns_ + since, kMostOwedNs);
}

Duration SliceBudget::rest_due(RobotTime now) const {
  return Duration{std::llround(std::max(owed_ns(now), 0.0) / (1 - options_.least_share))};
}

bool SliceBudget::has_turn(RobotTime now) const {
  return waiting_since_ ? owed_ns(now) >= turn_ns_ : in_turn_;
}

Duration SliceBudget::expected(const std::string& kind, double units) const {
  const auto known = costs_.find(kind);
  return known == costs_.end() ? Duration{0} : Duration{std::llround(known->second.longest_ns * units)};
}

std::optional<RobotTime> SliceBudget::wait(RobotTime now, const std::string& kind, double units) {
  const Duration cost = expected(kind, units);
  owed_ns_ = owed_ns(now);
  waiting_since_ = now;
  turn_ns_ = turn_of(cost);
  const auto may_run = [&](bool in_turn) -> std::optional<RobotTime> {
    waiting_since_.reset();
    in_turn_ = in_turn;
    return std::nullopt;
  };
  const auto once_owed = [&](double owed) {
    return now + Duration{1 + std::max<std::int64_t>(0, std::llround((owed - owed_ns_) / options_.least_share))};
  };
  const Ahead frames = ahead(now);
  if (frames.drawn_until) {
    if (owed_ns_ >= kUrgentNs) return may_run(true);
    return std::min(*frames.drawn_until, once_owed(kUrgentNs));
  }
  if (!frames.due || now + cost <= *frames.due) return may_run(false);
  if (owed_ns_ >= turn_ns_) return may_run(true);
  return once_owed(turn_ns_);
}

void SliceBudget::ran(RobotTime begin, RobotTime end, const std::string& kind, double units) {
  const double took = static_cast<double>((end - begin).count());
  owed_ns_ = std::max(owed_ns_ - (1 - options_.least_share) * took, took > kMostOwedNs ? -kMostDebtNs : -kMostSpareNs);
  Costs& costs = costs_[kind];
  const double unit = std::max(0.0, took) / std::max(units, 1.0);
  if (costs.ns.size() < kCosts)
    costs.ns.push_back(unit);
  else
    costs.ns[costs.next] = unit;
  costs.next = (costs.next + 1) % kCosts;
  costs.longest_ns = quantile(costs.ns, kQuantile);
  in_turn_ = owed_ns_ >= turn_of(expected(kind, units));  // so will be the next one, if there is one
}

double SliceBudget::units_now(RobotTime now, Duration slice, const std::string& kind, double units) const {
  const Ahead frames = ahead(now);
  const Duration left = frames.due && !frames.drawn_until ? *frames.due - now : slice;
  return units_within(left >= slice / kLeastParts ? std::min(left, slice) : slice, kind, units);
}

double SliceBudget::units_within(Duration time, const std::string& kind, double units) const {
  const auto known = costs_.find(kind);
  if (known == costs_.end() || known->second.longest_ns <= 0) return units;
  return std::clamp(std::floor(static_cast<double>(time.count()) / known->second.longest_ns), 1.0,
                    std::max(1.0, units));
}

}  // namespace foresight
