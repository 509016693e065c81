#include "drivers/robot/rest_watch.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kStillFor = 100ms, kBlindFor = 1s;
constexpr double kSlow = 0.01;  // share of the largest velocity

}  // namespace

RestWatch::RestWatch(std::vector<double> velocities, double feedback_age_s) : feedback_age_(seconds(feedback_age_s)) {
  joints_.resize(velocities.size());
  for (std::size_t i = 0; i < joints_.size(); ++i) joints_[i].velocity = velocities[i];
}

void RestWatch::see(std::span<const DriveFeedback> feedback, RobotTime now) noexcept {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    Joint& joint = joints_[i];
    const DriveFeedback& f = feedback[i];
    const double slow = kSlow * joint.velocity;
    const bool moved =
        std::isfinite(f.position) && !(std::abs(f.position - joint.anchor) <= slow * to_seconds(kStillFor));
    if (!begun_ || moved) {
      joint.moved = now;
      if (std::isfinite(f.position)) joint.anchor = f.position;
    }
    const bool tells = f.time.ns != 0 && now - f.time <= feedback_age_ && std::isfinite(f.position) &&
                       f.state != DriveState::offline && !(std::abs(f.velocity) > slow);
    joint.rests = f.state != DriveState::homing && now - joint.moved >= (tells ? kStillFor : kBlindFor);
  }
  begun_ = true;
}

bool RestWatch::at_rest() const noexcept {
  return std::all_of(joints_.begin(), joints_.end(), [](const Joint& joint) { return joint.rests; });
}

}  // namespace foresight
