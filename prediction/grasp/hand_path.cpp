#include "prediction/grasp/hand_path.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "prediction/path_follower.hpp"

namespace foresight {
namespace {

constexpr double kThere = 1e-4;  // m and rad

[[noreturn]] void refuse(const HandStop& stop, const std::string& why) {
  throw InputError("the hand's stop '" + stop.name + "'", why, "move it nearer, or give it more time");
}

}  // namespace

double minimum_jerk(double share) {
  return share * share * share * (10 + share * (6 * share - 15));
}

HandPath::HandPath(const InverseKinematics& kinematics, const JointVector& start, double grip,
                   std::span<const HandStop> stops)
    : joints_{start}, grips_{grip} {
  for (const HandStop& stop : stops) {
    if (!(stop.seconds > 0 && stop.seconds < 3600)) refuse(stop, fmt::format("takes {} s", stop.seconds));
    const int steps = std::max(1, static_cast<int>(std::lround(stop.seconds / kStep)));
    const double from = grips_.back();
    if (stop.by_joints)
      go_by_joints(kinematics, stop, steps);
    else
      go_straight(kinematics, stop, steps);
    for (int i = 1; i <= steps; ++i) grips_.push_back(std::lerp(from, stop.grip, minimum_jerk(double(i) / steps)));
    reached_.push_back(seconds());
  }
}

void HandPath::go_by_joints(const InverseKinematics& kinematics, const HandStop& stop, int steps) {
  const IkAnswer answer = kinematics.solve(stop.T_base_tip);
  if (answer.status != IkStatus::solved) refuse(stop, "is out of reach");
  const JointVector from = joints_.back();
  for (int i = 1; i <= steps; ++i) joints_.push_back(from + minimum_jerk(double(i) / steps) * (answer.q - from));
}

void HandPath::go_straight(const InverseKinematics& kinematics, const HandStop& stop, int steps) {
  PathFollower follower(kinematics, joints_.back());
  const Pose from = follower.hand();
  FollowStep last;
  for (int i = 1; i <= steps; ++i) {
    last = follower.step(pose_between(from, stop.T_base_tip, minimum_jerk(double(i) / steps)), kStep);
    joints_.push_back(last.q);
  }
  if (last.position_error > kThere || last.rotation_error > kThere)
    refuse(stop, fmt::format("is missed by {:.1f} mm ({})", 1e3 * last.position_error, name_of(last.reason)));
}

HandPath::Place HandPath::place(double seconds) const {
  const double at = std::clamp(seconds / kStep, 0.0, static_cast<double>(joints_.size() - 1));
  const auto before = static_cast<std::size_t>(at);
  return {before, at - static_cast<double>(before)};
}

JointVector HandPath::joints(double seconds) const {
  const Place at = place(seconds);
  if (at.share == 0) return joints_[at.before];
  return (1 - at.share) * joints_[at.before] + at.share * joints_[at.before + 1];
}

double HandPath::grip(double seconds) const {
  const Place at = place(seconds);
  return at.share == 0 ? grips_[at.before] : std::lerp(grips_[at.before], grips_[at.before + 1], at.share);
}

}  // namespace foresight
