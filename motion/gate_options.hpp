// What a robot's safety gate was told, and what whoever predicts it has to know: limits, times, surroundings.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "motion/joint_motion.hpp"
#include "motion/robot_shape.hpp"

namespace foresight {

inline constexpr std::size_t kMostJoints = 16;
using JointValues = std::array<double, kMostJoints>;

struct GateJoint {
  std::string name;
  JointLimits limits;
  double following_error = 0.1;  ///< largest distance between set-point and feedback; > 0
  bool keeps_grip = false;       ///< a gripper: never told to release by a stop
  /// It may be asked to stand there. A little beyond a limit, as rounding makes it, means the limit.
  bool reaches(double position) const noexcept;
};

struct GateOptions {
  double rate_hz = 250;
  double command_age_s = 0.1;     ///< older commands are dropped; the operator counts as lost then
  double feedback_age_s = 0.05;   ///< older feedback is frozen feedback
  double ramp_s = 2;              ///< time from a tenth to the full speed after each start
  std::vector<GateJoint> joints;  ///< 1 .. kMostJoints
  Surroundings surroundings;
  /// Throws InputError at `where`: numbers out of range, limits that contradict each other.
  void validate(const std::string& where) const;
  /// Share of the velocities that is let through so long after somebody engaged: kFirstSpeed .. 1.
  double speed_after(Duration engaged) const noexcept;

  static constexpr double kFirstSpeed = 0.1;  ///< of the ramp
};

/// What a safety gate does, as far as who predicts it has to know.
enum class GateDoing : std::uint8_t {
  idle,       ///< would follow who presses the switch
  following,  ///< goes where the set-points say
  stopping,   ///< slows down to rest
  stopped,    ///< latched: set-points brake, nothing is followed until somebody resets it
  away,       ///< set-points say nothing of where the robot is: without torque, enabling, looking for home
};

}  // namespace foresight
