// How the head and the arm of a synthetic run move. Smooth, endless, the same every time.
#pragma once

#include "sim/arm.hpp"
#include "sim/lab.hpp"

namespace foresight::sim {

/// The left camera of a head that looks about, comes close to the table and goes back. `t` in
/// seconds from the start.
Pose T_world_camera_at(double t);

/// The arm reaches over the table, down and back: a closed cubic spline through kArmKeys in the
/// joints, with continuous acceleration.
/// `order`: another one goes from key to key in another order, 0 in that of the array.
ArmPosition arm_position_at(double t, unsigned order = 0);
inline constexpr double kArmPeriod = 12;  ///< seconds

/// Where all parts of `lab` stand at `t`.
LabState lab_state_at(const Lab& lab, double t, unsigned order = 0);

/// Right camera of the stereo rig in the left camera's frame: 65 mm to the right, slightly toed in.
Pose T_left_right();

}  // namespace foresight::sim
