#include "input/rate_hand.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

Eigen::Vector3d bounded(const Eigen::Vector3d& v) noexcept {
  if (!v.allFinite()) return Eigen::Vector3d::Zero();
  const double largest = v.cwiseAbs().maxCoeff();
  if (largest > 1e100) return Eigen::Vector3d::Zero();
  return v / std::max(1.0, v.norm());
}

}  // namespace

const Pose& RateHand::step(OperatorTime now, const HandRate& rate) noexcept {
  const Duration passed = last_ && now > *last_ ? now - *last_ : Duration{0};
  const double dt = passed <= options_.longest_step ? to_seconds(passed) : 0;
  if (!last_ || now > *last_) last_ = now;
  const Eigen::Vector3d way = bounded(rate.linear) * (options_.speed * dt);
  const Eigen::Vector3d turn = bounded(rate.angular) * (options_.turn * dt);
  pose_.translation() += way;
  if (const double angle = turn.norm(); angle > 0) {
    const Eigen::AngleAxisd step(angle, turn / angle);
    pose_.linear() = Eigen::Quaterniond(step * pose_.linear()).normalized().toRotationMatrix();
  }
  return pose_;
}

double without_dead_zone(double deflection, double dead) noexcept {
  if (!std::isfinite(deflection)) return 0;
  const double size = std::min(std::abs(deflection), 1.0);
  return size <= dead ? 0 : std::copysign((size - dead) / (1 - dead), deflection);
}

}  // namespace foresight
