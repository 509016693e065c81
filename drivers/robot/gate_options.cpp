// What the gate can be told, and what it says.
#include <cmath>

#include "common/error.hpp"
#include "drivers/robot/safety_gate.hpp"

namespace foresight {
namespace {

void require(bool ok, const std::string& where, const std::string& what, const std::string& cure) {
  if (!ok) throw InputError(where, what, cure);
}

}  // namespace

const char* to_string(GateState state) {
  switch (state) {
    case GateState::idle: return "idle";
    case GateState::following: return "following";
    case GateState::homing: return "homing";
    case GateState::stopping: return "stopping";
    case GateState::stopped: return "stopped";
  }
  return "?";
}

const char* to_string(GateReason reason) {
  switch (reason) {
    case GateReason::none: return "";
    case GateReason::not_finite: return "a commanded position is not a number";
    case GateReason::wrong_joint_count: return "a command for another number of joints";
    case GateReason::out_of_range: return "a commanded position is beyond the joint's limits";
    case GateReason::expired: return "a command came too late";
    case GateReason::from_the_future: return "a command is stamped in the future";
    case GateReason::out_of_order: return "a command is older than one before it";
    case GateReason::second_operator: return "another operator is in charge";
    case GateReason::obstructed: return "the way is obstructed";
    case GateReason::operator_lost: return "no command in time: the operator is lost";
    case GateReason::deadman_released: return "the deadman switch was released";
    case GateReason::emergency_stop: return "emergency stop";
    case GateReason::following_error: return "the joint does not follow its set-points";
    case GateReason::stands_out_of_range:
      return "the joint stands beyond its limits; move it back by hand, or correct them";
    case GateReason::feedback_lost: return "no position from the drive in time";
    case GateReason::feedback_not_finite: return "the drive's position is not a number";
    case GateReason::feedback_frozen: return "the drive's position does not change while it should";
    case GateReason::feedback_jumps: return "the drive's position jumps";
    case GateReason::drive_fault: return "the drive reports a fault";
    case GateReason::drive_offline: return "the drive does not answer";
    case GateReason::drive_not_enabled: return "the drive is no longer enabled";
    case GateReason::bus_fault: return "the bus is not usable";
  }
  return "?";
}

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

}  // namespace foresight
