// The limits of a rig's joint: from the rig file, from the URDF where it says none, and refused where they cannot be.
#pragma once

#include "rig/rig.hpp"

namespace foresight {

class YamlMap;

/// Throws InputError naming the file and the joint whose limits in the URDF are degrees or millimetres, by their size,
/// or that cannot move at all because of what follows it.
void require_joint_units(const UrdfRobot& robot, const std::string& file);

/// Reads unit, min, max, velocity, acceleration, jerk, following_error and homing_velocity. `urdf`: the joint in the
/// URDF, within what follows it, or null. Its limits are the defaults of min, max and velocity, and bounds of what the
/// rig may say. `rate_hz`: the control loop's. Throws InputError naming the field, both numbers, and where it can a
/// guess at the mistake (degrees for radians, millimetres for metres): a unit that does not fit the joint, limits
/// beyond the URDF's, more than two turns, 10 m or 30 rad/s where the URDF says nothing, a velocity from which the
/// joint cannot stop within its range, one that it reaches within a cycle, a following error that would stop nothing.
void read_limits(const YamlMap& map, const UrdfJoint* urdf, double rate_hz, RigJoint& joint);

/// Throws InputError where a count is too coarse for the joint's following error, or its range exceeds 32 bits.
void check_counts(const YamlMap& map, const RigJoint& joint);

}  // namespace foresight
