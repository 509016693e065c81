#include "apps/bench/random_motion.hpp"

#include <algorithm>
#include <cmath>

#include "prediction/grasp/hand_path.hpp"

namespace foresight {
namespace {

constexpr double kMoreClearance = 0.005;  // m more than the gate keeps clear
constexpr double kRange = 0.7;            // of each joint's range
constexpr double kAtOnce = 0.3;           // share of legs whose end is asked for at once
constexpr double kPeak = 1.875;           // of minimum jerk, times the mean speed
constexpr int kTries = 300, kSamples = 24;

}  // namespace

RandomMotion::RandomMotion(const Rig& rig, const JointValues& start, unsigned seed)
    : rig_(rig), shape_(rig.shape()), random_(seed) {
  Surroundings wide = rig.surroundings;
  wide.clearance += kMoreClearance;
  if (shape_) shape_->surround(wide);
  leg_.from = leg_.to = start;
}

JointValues RandomMotion::any_goal(double share) {
  JointValues goal{};
  for (std::size_t i = 0; i < rig_.joints.size(); ++i) {
    const DriveConfig& d = rig_.joints[i].drive;
    const double middle = 0.5 * (d.min_position + d.max_position);
    const double anywhere = middle + kRange * 0.5 * (d.max_position - d.min_position) * uniform(-1, 1);
    goal[i] = std::lerp(leg_.from[i], anywhere, share);
  }
  return goal;
}

bool RandomMotion::is_clear(const JointValues& from, const JointValues& to) {
  if (!shape_) return true;
  JointValues between{};
  for (int k = 1; k <= kSamples; ++k) {
    for (std::size_t i = 0; i < rig_.joints.size(); ++i)
      between[i] = std::lerp(from[i], to[i], static_cast<double>(k) / kSamples);
    if (shape_->obstructed({between.data(), rig_.joints.size()}) != nullptr) return false;
  }
  return true;
}

void RandomMotion::next_leg() {
  leg_.begin += leg_.lasts;
  leg_.from = leg_.to;
  // Where nothing is clear, it goes less far.
  for (int i = 0; i < kTries; ++i) {
    leg_.to = any_goal(i < kTries / 2 ? 1.0 : 1.0 - static_cast<double>(i) / kTries);
    if (is_clear(leg_.from, leg_.to)) break;
    leg_.to = leg_.from;
  }
  leg_.at_once = uniform(0, 1) < kAtOnce;
  const double share = std::min(1.0, uniform(0.3, 1.3));
  double slowest = 0;
  for (std::size_t i = 0; i < rig_.joints.size(); ++i)
    slowest = std::max(slowest, std::abs(leg_.to[i] - leg_.from[i]) / rig_.joints[i].drive.max_velocity);
  leg_.lasts = leg_.at_once ? slowest + uniform(0.5, 1.5) : kPeak * slowest / share + uniform(0, 0.5);
  leg_.lasts = std::max(leg_.lasts, 0.2);
}

JointValues RandomMotion::at(double seconds) {
  while (seconds >= leg_.begin + leg_.lasts) next_leg();
  if (leg_.at_once) return leg_.to;
  const double share = minimum_jerk(std::clamp((seconds - leg_.begin) / leg_.lasts, 0.0, 1.0));
  JointValues out{};
  for (std::size_t i = 0; i < rig_.joints.size(); ++i) out[i] = std::lerp(leg_.from[i], leg_.to[i], share);
  return out;
}

}  // namespace foresight
