#include "motion/gate_options.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"

namespace foresight {

void GateOptions::validate(const std::string& where) const {
  require(rate_hz >= 10 && rate_hz <= 2000, where, "rate_hz is " + std::to_string(rate_hz), "choose from 10 to 2000");
  require(command_age_s > 1 / rate_hz && command_age_s <= 2, where, "command_age_s is " + std::to_string(command_age_s),
          "choose more than one cycle, and at most 2");
  require(feedback_age_s > 1 / rate_hz && feedback_age_s <= 1, where,
          "feedback_age_s is " + std::to_string(feedback_age_s), "choose more than one cycle, and at most 1");
  require(ramp_s >= 0 && ramp_s <= 60, where, "ramp_s is " + std::to_string(ramp_s), "choose from 0 to 60");
  require(!joints.empty() && joints.size() <= kMostJoints, where, std::to_string(joints.size()) + " joints",
          "give 1 to " + std::to_string(kMostJoints));
  for (const GateJoint& joint : joints) {
    const std::string at = where + ": joint '" + joint.name + "'";
    const JointLimits& l = joint.limits;
    require(std::isfinite(l.min_position) && std::isfinite(l.max_position) && l.min_position < l.max_position, at,
            "the least position " + std::to_string(l.min_position) + " is not below the largest, " +
                std::to_string(l.max_position),
            "exchange or correct them");
    for (const auto& [name, value] : {std::pair("velocity", l.velocity),
                                      {"acceleration", l.acceleration},
                                      {"jerk", l.jerk},
                                      {"following error", joint.following_error}})
      require(std::isfinite(value) && value > 0, at,
              "its largest " + std::string(name) + " is " + std::to_string(value), "give a number above 0");
    require(l.velocity / rate_hz < joint.following_error, at,
            "in one cycle it moves " + std::to_string(l.velocity / rate_hz) + ", more than its following error of " +
                std::to_string(joint.following_error),
            "allow more following error or less velocity");
  }
  require(surroundings.clearance > 0 && surroundings.clearance < 1, where,
          "the clearance is " + std::to_string(surroundings.clearance), "choose between 0 and 1 m");
}

bool GateJoint::reaches(double position) const noexcept {
  constexpr double kRounding = 1e-6;
  return position >= limits.min_position - kRounding && position <= limits.max_position + kRounding;
}

double GateOptions::speed_after(Duration engaged) const noexcept {
  const double ramped = ramp_s > 0 ? to_seconds(engaged) / ramp_s : 1;
  return std::clamp(kFirstSpeed + (1 - kFirstSpeed) * ramped, kFirstSpeed, 1.0);
}

}  // namespace foresight
