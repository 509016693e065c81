#include "sim/drives/homing_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/drives/drive_node.hpp"

namespace foresight::sim {
namespace {

using Edge = HomingMethod::Edge;

constexpr double kFar = 1e9;              // beyond all ways
constexpr double kIndexes = 100;          // index pulses over the range: one motor turn each, behind a gear
constexpr double kBeyond = 0.01;          // of the range: from its end to the limit switch
constexpr double kHomeSwitchPart = 0.04;  // of the range, where it does not reach to the end

// Methods 1 .. 14; 17 .. 30 are the same without the index pulse.
constexpr std::array<HomingMethod, 14> kMethods{{
    {kNegativeLimit, Edge::upper, +1},
    {kPositiveLimit, Edge::lower, -1},
    {kHomeSwitch, Edge::lower, -1, 0, true},
    {kHomeSwitch, Edge::lower, +1, 0, true},
    {kHomeSwitch, Edge::upper, +1, 0, true},
    {kHomeSwitch, Edge::upper, -1, 0, true},
    {kHomeSwitch, Edge::lower, -1, +1},
    {kHomeSwitch, Edge::lower, +1, +1},
    {kHomeSwitch, Edge::upper, -1, +1},
    {kHomeSwitch, Edge::upper, +1, +1},
    {kHomeSwitch, Edge::upper, +1, -1},
    {kHomeSwitch, Edge::upper, -1, -1},
    {kHomeSwitch, Edge::lower, +1, -1},
    {kHomeSwitch, Edge::lower, -1, -1},
}};

}  // namespace

std::optional<HomingMethod> homing_method(int number) {
  if (number == 33 || number == 34) return HomingMethod{0, Edge::none, number == 33 ? -1 : 1, 0, false, true};
  const bool index = number >= 1 && number <= 14;
  if (!index && (number < 17 || number > 30)) return std::nullopt;
  HomingMethod out = kMethods[static_cast<std::size_t>(index ? number - 1 : number - 17)];
  out.index = index;
  return out;
}

const std::vector<int>& served_homing_methods() {
  static const std::vector<int> all = [] {
    std::vector<int> out;
    for (int number = 1; number <= 37; ++number)
      if (homing_method(number) || number == 35 || number == 37) out.push_back(number);
    return out;
  }();
  return all;
}

void place_homing_switches(NodeConfig& config, int number, double home) {
  const double range = config.max_position - config.min_position;
  config.low_switch = config.min_position - kBeyond * range;
  config.high_switch = config.max_position + kBeyond * range;
  config.index_at = home;
  config.index_distance = range / kIndexes;
  const auto method = homing_method(number);
  if (!method) return;
  if (method->edge == Edge::none) {
    config.index_distance = kFar;  // one pulse only: which one it is must not depend on where the search begins
    return;
  }
  const double edge = home - (method->index ? 0.5 * method->way * config.index_distance : 0);
  if (method->input == kNegativeLimit) config.low_switch = edge;
  if (method->input == kPositiveLimit) config.high_switch = edge;
  if (method->input != kHomeSwitch) return;
  const double closed = method->endless ? kFar : kHomeSwitchPart * range;
  config.home_switch_low = method->edge == Edge::lower ? edge : edge - closed;
  config.home_switch_high = method->edge == Edge::lower ? edge + closed : edge;
}

HomingSearch::HomingSearch(const HomingMethod& method, double index_distance, double index_at)
    : method_(method), index_distance_(index_distance), index_at_(index_at) {
  if (method.edge == Edge::none) phase_ = Phase::index;
}

// On which side of the edge the shaft is before it is crossed.
HomingSearch::Side HomingSearch::before() const {
  if (method_.edge == Edge::lower) return method_.way > 0 ? Side::below : Side::inside;
  return method_.way > 0 ? Side::inside : Side::above;
}

HomingSearch::Side HomingSearch::after() const {
  if (method_.edge == Edge::lower) return method_.way > 0 ? Side::inside : Side::below;
  return method_.way > 0 ? Side::above : Side::inside;
}

void HomingSearch::see_side(double shaft, unsigned inputs) {
  if ((inputs & method_.input) != 0) {
    side_ = Side::inside;
  } else if (method_.first == 0) {
    side_ = method_.edge == Edge::lower ? Side::below : Side::above;  // the other one lies beyond the end of the way
  } else if (side_ == Side::inside) {
    side_ = shaft > *last_ ? Side::above : Side::below;
  } else if (side_ == Side::unknown && (inputs & (kNegativeLimit | kPositiveLimit)) != 0) {
    side_ = (inputs & kNegativeLimit) != 0 ? Side::below : Side::above;
  }
}

HomingSearch::Speed HomingSearch::move(int direction, bool fast, unsigned inputs) {
  const unsigned ahead = direction > 0 ? kPositiveLimit : kNegativeLimit;
  if ((inputs & ahead) != 0 && method_.input != ahead) {
    phase_ = Phase::failed;
    return Speed::stand;
  }
  return static_cast<Speed>(direction * (fast ? 2 : 1));
}

// To the side from which the edge is crossed.
HomingSearch::Speed HomingSearch::seek(unsigned inputs) {
  if (side_ == before()) {
    phase_ = Phase::cross;
    return move(method_.way, false, inputs);
  }
  if (side_ == Side::unknown) return move(method_.first, true, inputs);
  return move(before() > side_ ? 1 : -1, true, inputs);
}

bool HomingSearch::passed_index(double shaft) {
  if (!last_) return false;
  const double from = (*last_ - index_at_) / index_distance_, to = (shaft - index_at_) / index_distance_;
  const double pulse = method_.way > 0 ? std::floor(to) : std::ceil(to);
  const bool passed = method_.way > 0 ? pulse > from : pulse < from;
  if (passed) home_ = index_at_ + pulse * index_distance_;
  return passed;
}

HomingSearch::Speed HomingSearch::step(double shaft, unsigned inputs) {
  if (phase_ == Phase::found || phase_ == Phase::failed) return Speed::stand;
  Speed out = Speed::stand;
  if (phase_ != Phase::index) see_side(shaft, inputs);
  // Far on the right side of the edge: fast over it, to come back to it slowly.
  if (phase_ == Phase::approach) {
    if (side_ != before())
      phase_ = Phase::seek;
    else
      out = move(method_.way, true, inputs);
  }
  if (phase_ == Phase::seek) {
    out = seek(inputs);
  } else if (phase_ == Phase::cross) {
    if (side_ == after()) {
      phase_ = method_.index ? Phase::index : Phase::found;
      if (!method_.index) home_ = shaft;
      last_ = shaft;  // pulses count from here on
    } else {
      out = move(method_.way, false, inputs);
    }
  }
  if (phase_ == Phase::index) {
    if (passed_index(shaft))
      phase_ = Phase::found;
    else
      out = move(method_.way, false, inputs);
  }
  last_ = shaft;
  return phase_ == Phase::found ? Speed::stand : out;
}

}  // namespace foresight::sim
