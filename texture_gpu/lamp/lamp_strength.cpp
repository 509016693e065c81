#include "texture_gpu/lamp/lamp_strength.hpp"

#include <cmath>
#include <limits>

#include "texture_gpu/lamp/lamp.hpp"

namespace foresight {
namespace {

using Eigen::Array3d;
using Eigen::Array3i;
using Eigen::Vector3d;

// Observations of shadows that tell how strong a lamp is: fewer may lie in the border of one that is foretold a bit
// aside. A lamp that is off has so little left of its strength.
constexpr std::size_t kFewestShadows = 120;
constexpr double kGoneShare = 0.25;
// What lamps may give, as shares of all other light: of so many, each so many times the one before.
constexpr double kLeastShare = 0.02, kShareStep = 1.05;
constexpr int kShares = 161, kSharesAtOnce = 4;

double share_of(int step) {
  return kLeastShare * std::pow(kShareStep, step);
}

/// Of each channel: the step with the least error.
struct Best {
  Array3d least = Array3d::Constant(std::numeric_limits<double>::infinity());
  Array3i step = Array3i::Zero();

  void look_at(int other, const Array3d& error) {
    for (int c = 0; c < 3; ++c)
      if (error[c] < least[c]) least[c] = error[c], step[c] = other;
  }
};

Array3d errors(const std::vector<MovingShadows::Shadowed>& shadowed, double strength) {
  Array3d out = Array3d::Zero();
  for (const auto& [deviation, facing, hidden, usually] : shadowed) {
    const double share = strength * facing;
    out += (deviation.cast<double>().array() - std::log(shadow_factor(share, hidden) / shadow_factor(share, usually)))
               .abs();
  }
  return out;
}

}  // namespace

bool LampStrength::is_told_by_what_moves() const {
  return shadows >= kFewestShadows;
}

bool LampStrength::is_gone(const Vector3d& usual) const {
  return is_told_by_what_moves() && moving.sum() < kGoneShare * usual.sum();
}

LampStrength lamp_strength(const MovingShadows& moving, const StillShadows& still, const Vector3d& lamp,
                           double radius) {
  static const Disc coarsely = spiral(ShadowRays::kPacket), finely = spiral(3 * ShadowRays::kPacket);
  const auto shadowed = moving.shadowed(lamp, radius, coarsely, finely);
  const StillShadows::Cast cast = still.cast(lamp, radius, coarsely);
  LampStrength out{.shadows = shadowed.size()};
  double mean = 0;
  for (const MovingShadows::Shadowed& s : shadowed) mean += s.facing;
  mean += cast.facing.sum();
  mean /= static_cast<double>(std::max<std::ptrdiff_t>(1, std::ssize(shadowed) + cast.facing.size()));
  if (!(mean > 0)) return out;
  Best best_moving, best_still;
  const auto look_at = [&](int step) {
    const double strength = share_of(step) / mean;
    best_moving.look_at(step, errors(shadowed, strength));
    best_still.look_at(step, still.errors(cast, strength));
  };
  // In wide steps, and in narrow ones around the best.
  for (int step = 0; step < kShares; step += kSharesAtOnce) look_at(step);
  const Array3i of_moving = best_moving.step, of_still = best_still.step;
  for (int step = 0; step < kShares; ++step) {
    const bool is_near = ((of_moving - step).abs() < kSharesAtOnce || (of_still - step).abs() < kSharesAtOnce).any();
    if (step % kSharesAtOnce != 0 && is_near) look_at(step);
  }
  for (int c = 0; c < 3; ++c) {
    out.moving[c] = share_of(best_moving.step[c]) / mean;
    out.still[c] = share_of(best_still.step[c]) / mean;
  }
  return out;
}

}  // namespace foresight
