#include "prediction/pose_trail.hpp"

#include <algorithm>
#include <cmath>

#include "common/rotation.hpp"
#include "prediction/arm_chain.hpp"

namespace foresight {
namespace {

constexpr double kTolerance = 3e-3;  // of a rotation matrix whose quaternion has the three decimals of files

}  // namespace

PoseTrail::PoseTrail(const PoseTrailOptions& options) : options_(options) {}

bool PoseTrail::jumps(const Sample& from, double stamp, const Pose& to) const noexcept {
  const Vector6 step = pose_difference(from.pose, to);
  const double way = step.head<3>().norm(), turn = step.tail<3>().norm(), seconds = stamp - from.stamp;
  return (way > options_.least_jump && way > options_.fastest * seconds) ||
         (turn > 4 * options_.least_jump && turn > options_.fastest_turn * seconds);
}

double PoseTrail::even_time(double stamp) noexcept {
  constexpr double kDraw = 0.05;      // share of the way to the stamp that each even time goes
  constexpr double kTooUneven = 0.2;  // of a step: beyond it nobody can count how many steps have passed
  constexpr double kFade = 0.95;
  const Sample& last = samples_.newest();
  steps_.next() = stamp - last.stamp;
  std::array<double, kSteps> sorted{};
  for (std::size_t i = 0; i < steps_.size(); ++i) sorted[i] = steps_[i];
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(steps_.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(steps_.size()));
  const double step = *middle, count = std::max(1.0, std::round((stamp - last.even) / step));
  const double expected = last.even + count * step, off = stamp - expected;
  unevenness_ = kFade * unevenness_ + (1 - kFade) * std::abs(off) / step;
  const double even = unevenness_ > kTooUneven || std::abs(off) > step ? stamp : expected + kDraw * off;
  return std::max(even, last.even + 0.1 * step);
}

PoseTaken PoseTrail::add(OperatorTime time, const Pose& pose) noexcept {
  if (!is_rigid(pose, kTolerance)) return PoseTaken::invalid;
  if (!begun_) epoch_ = time;
  begun_ = true;
  const double stamp = to_seconds(time - epoch_);
  bool anew = samples_.empty();
  if (!anew) {
    const Sample& last = samples_.newest();
    if (time <= last.time) return PoseTaken::late;
    anew = stamp - last.stamp > options_.largest_gap || jumps(last, stamp, pose);
  }
  if (anew) samples_.clear();
  const double even = anew ? stamp : even_time(stamp);
  samples_.next() = {time, stamp, even, pose};
  return anew ? PoseTaken::anew : PoseTaken::yes;
}

double PoseTrail::length() const noexcept {
  return samples_.empty() ? 0 : samples_.newest().even - samples_[0].even;
}

Pose PoseTrail::back(double lag) const noexcept {
  const double wanted = samples_.newest().even - lag;
  std::size_t after = samples_.size() - 1;
  if (after == 0 || lag <= 0) return samples_.newest().pose;
  while (after > 1 && samples_[after - 1].even > wanted) --after;
  const Sample &a = samples_[after - 1], &b = samples_[after];
  return pose_between(a.pose, b.pose, (wanted - a.even) / (b.even - a.even));
}

}  // namespace foresight
