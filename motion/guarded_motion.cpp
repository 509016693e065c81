#include "motion/guarded_motion.hpp"

#include <algorithm>

namespace foresight {
namespace {

constexpr int kSamplesToRest = 4;      // poses checked on the way to where the robot would stop
constexpr double kRetreatSpeed = 0.1;  // away from what the robot stands too close to
constexpr double kSameMargin = 1e-9;   // metres, rounding

}  // namespace

GuardedMotion::GuardedMotion(const GateOptions& options, RobotShape* shape) : dt_(1 / options.rate_hz), shape_(shape) {
  options.validate("safety gate");
  for (const GateJoint& joint : options.joints) limits_.push_back(joint.limits);
  if (shape_ == nullptr) return;
  shape_->surround(options.surroundings);
  here_.resize(shape_->couples());
  there_.resize(shape_->couples());
}

GuardedMotion::Motions GuardedMotion::towards(const JointValues& targets, double speed) const noexcept {
  Motions next = motion_;
  for (std::size_t i = 0; i < limits_.size(); ++i) next[i] = approach(motion_[i], targets[i], limits_[i], speed, dt_);
  return next;
}

/// `check` looks at the margins (there_) of poses from the next one to where the robot would stop after it.
template <typename Check>
bool GuardedMotion::all_to_rest(const Motions& next, Check&& check) noexcept {
  JointValues here{}, rest{}, between{};
  for (std::size_t i = 0; i < limits_.size(); ++i) {
    here[i] = next[i].position;
    rest[i] = stop_position(next[i], limits_[i], dt_);
  }
  for (int k = 0; k <= kSamplesToRest; ++k) {
    const double share = static_cast<double>(k) / kSamplesToRest;
    for (std::size_t i = 0; i < limits_.size(); ++i) between[i] = here[i] + share * (rest[i] - here[i]);
    shape_->margins({between.data(), limits_.size()}, there_);
    if (!check()) return false;
  }
  return true;
}

/// The couple of parts that would come too close.
std::optional<std::size_t> GuardedMotion::blocking(const Motions& next) noexcept {
  std::optional<std::size_t> out;
  if (shape_ == nullptr) return out;
  all_to_rest(next, [&] {
    const auto least = std::min_element(there_.begin(), there_.end());
    if (least == there_.end() || *least >= 0) return true;
    out = static_cast<std::size_t>(least - there_.begin());
    return false;
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
bool GuardedMotion::retreats(const Motions& next) noexcept {
  const double least = *std::min_element(here_.begin(), here_.end());
  if (least >= 0) return false;
  const bool only_part = all_to_rest(next, [this] {
    for (std::size_t c = 0; c < there_.size(); ++c)
      if (there_[c] < 0 && there_[c] < here_[c] - kSameMargin) return false;
    std::swap(here_, there_);
    return true;
  });
  return only_part && *std::min_element(here_.begin(), here_.end()) > least + kSameMargin;
}

std::optional<GuardedMotion::Blocked> GuardedMotion::go_towards(const JointValues& targets, double speed) noexcept {
  const Motions next = towards(targets, speed);
  const auto couple = blocking(next);
  if (!couple) {
    motion_ = next;
    return std::nullopt;
  }
  measure_here();
  const Blocked blocked{*couple, here_[*couple]};
  const Motions slow = towards(targets, std::min(speed, kRetreatSpeed));
  if (retreats(slow))
    motion_ = slow;
  else
    halt();
  return blocked;
}

void GuardedMotion::halt() noexcept {
  for (std::size_t i = 0; i < limits_.size(); ++i) motion_[i] = brake(motion_[i], limits_[i], dt_);
}

bool GuardedMotion::at_rest() const noexcept {
  return std::all_of(motion_.begin(), motion_.begin() + static_cast<std::ptrdiff_t>(limits_.size()),
                     [](const JointMotion& m) { return m.velocity == 0 && m.acceleration == 0; });
}

}  // namespace foresight
