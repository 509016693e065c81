#include "motion/guarded_motion.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

constexpr int kSamplesToRest = 16;          // poses checked on the way to where the robot would stop
constexpr int kMostCyclesToRest = 100'000;  // only to end the loop with motions that are nonsense
constexpr double kRetreatSpeed = 0.1;       // away from what the robot stands too close to
constexpr double kSameMargin = 1e-9;        // metres, rounding

/// A cycle of the fastest stop of all joints. How far they go in it, all together.
double brake_all(GuardedMotion::Motions& motions, std::span<const JointLimits> limits, double dt) {
  double gone = 0;
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const JointMotion next = brake(motions[i], limits[i], dt);
    gone += std::abs(next.position - motions[i].position);
    motions[i] = next;
  }
  return gone;
}

bool all_rest(const GuardedMotion::Motions& motions, std::size_t joints) {
  return std::all_of(motions.begin(), motions.begin() + static_cast<std::ptrdiff_t>(joints),
                     [](const JointMotion& m) { return m.velocity == 0 && m.acceleration == 0; });
}

}  // namespace

GuardedMotion::GuardedMotion(const GateOptions& options, RobotShape* shape) : dt_(1 / options.rate_hz), shape_(shape) {
  options.validate("safety gate");
  for (const GateJoint& joint : options.joints) limits_.push_back(joint.limits);
  if (shape_ == nullptr) return;
  shape_->surround(options.surroundings);
  here_.resize(shape_->couples());
  there_.resize(shape_->couples());
}

GuardedMotion::Next GuardedMotion::towards(const JointValues& targets, double speed) const noexcept {
  Next next{motion_};
  for (std::size_t i = 0; i < limits_.size(); ++i) {
    const StoppableMotion one = approach(motion_[i], targets[i], limits_[i], speed, dt_);
    next.motion[i] = one.motion;
    next.stop[i] = one.stop;
  }
  return next;
}

/// `check` is asked of positions from the next ones to where the robot would stop after them. Each joint brakes for its
/// own time, so these lie on no straight line between the two; they follow each other at equal shares of the way that
/// all joints go together.
template <typename Check>
bool GuardedMotion::all_to_rest(const Next& next, Check&& check) noexcept {
  const std::size_t joints = limits_.size();
  Motions motions = next.motion;
  const auto clear = [&] {
    JointValues positions{};
    for (std::size_t i = 0; i < joints; ++i) positions[i] = motions[i].position;
    return check(std::span<const double>(positions.data(), joints));
  };
  double way = 0;
  for (std::size_t i = 0; i < joints; ++i) way += std::abs(next.stop[i] - motions[i].position);
  if (!clear()) return false;
  double since = 0;
  for (int cycle = 0; cycle < kMostCyclesToRest && !all_rest(motions, joints); ++cycle) {
    since += brake_all(motions, limits_, dt_);
    if (since < way / kSamplesToRest && !all_rest(motions, joints)) continue;
    if (!clear()) return false;
    since = 0;
  }
  return true;
}

/// The couple of parts that would come too close.
std::optional<std::size_t> GuardedMotion::blocking(const Next& next) noexcept {
  std::optional<std::size_t> out;
  if (shape_ == nullptr) return out;
  all_to_rest(next, [&](std::span<const double> positions) {
    out = shape_->too_close(positions);
    return !out;
  });
  return out;
}

void GuardedMotion::measure_here() noexcept {
  JointValues now{};
  for (std::size_t i = 0; i < limits_.size(); ++i) now[i] = motion_[i].position;
  shape_->margins({now.data(), limits_.size()}, here_);
}

/// After measure_here(), which found some parts too close: these only ever part, the closest of them for certain, and
/// no others come too close. Loses what was measured.
bool GuardedMotion::retreats(const Next& next) noexcept {
  const double least = *std::min_element(here_.begin(), here_.end());
  if (least >= 0) return false;
  const bool only_part = all_to_rest(next, [this](std::span<const double> positions) {
    shape_->margins(positions, there_);
    for (std::size_t c = 0; c < there_.size(); ++c)
      if (there_[c] < 0 && there_[c] < here_[c] - kSameMargin) return false;
    std::swap(here_, there_);
    return true;
  });
  return only_part && *std::min_element(here_.begin(), here_.end()) > least + kSameMargin;
}

std::optional<GuardedMotion::Blocked> GuardedMotion::go_towards(const JointValues& targets, double speed) noexcept {
  const Next next = towards(targets, speed);
  const auto couple = blocking(next);
  if (!couple) {
    motion_ = next.motion;
    return std::nullopt;
  }
  measure_here();
  const Blocked blocked{*couple, here_[*couple]};
  const Next slow = towards(targets, std::min(speed, kRetreatSpeed));
  if (retreats(slow))
    motion_ = slow.motion;
  else
    halt();
  return blocked;
}

void GuardedMotion::halt() noexcept {
  brake_all(motion_, limits_, dt_);
}

bool GuardedMotion::at_rest() const noexcept {
  return all_rest(motion_, limits_.size());
}

}  // namespace foresight
