#include "input/force.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

double within(double value, double most) noexcept {
  return std::isfinite(value) ? std::clamp(value, 0.0, most) : 0;
}

}  // namespace

void BoundedForce::feel(OperatorTime now, const HandContact& contact) noexcept {
  const double length = contact.out_in_space.norm();
  const bool touches = std::isfinite(length) && length > 1e-9;
  wanted_.out_in_space = Eigen::Vector3d::Zero();
  if (touches) wanted_.out_in_space = contact.out_in_space / length;
  wanted_.depth = touches ? within(contact.depth, limits_.depth) : 0;
  wanted_.damping = touches ? within(contact.damping, limits_.damping) : 0;
  felt_ = now;
}

void BoundedForce::cycle(OperatorTime now, bool engaged) noexcept {
  const double passed = last_ && now > *last_ ? to_seconds(now - *last_) : 0;
  last_ = now;
  const bool fresh = felt_ && now - *felt_ <= limits_.stale_after && now >= *felt_;
  HandContact out;
  if (engaged && fresh) out = wanted_;
  out.depth = depth_ = std::min(out.depth, depth_ + limits_.depth_per_s * std::min(passed, 0.1));
  device_.push(now, out);
}

void RecordedForce::push(OperatorTime now, const HandContact& contact) noexcept {
  if (most_ == 0) return;
  if (rows_.size() < most_) {
    rows_.push_back({now, contact});  // within what was reserved
    return;
  }
  rows_[oldest_] = {now, contact};
  oldest_ = (oldest_ + 1) % most_;
}

std::vector<RecordedForce::Row> RecordedForce::rows() const {
  std::vector<Row> out = rows_;
  std::rotate(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(oldest_), out.end());
  return out;
}

}  // namespace foresight
