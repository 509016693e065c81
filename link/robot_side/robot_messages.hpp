// What the robot side knows, as messages. Pure functions: nothing here waits, sends or asks for the time.
#pragma once

#include "link/control/messages.hpp"
#include "link/messages/foresight_messages.hpp"
#include "rig/rig.hpp"
#include "scene/stereo_lenses.hpp"
#include "session/camera_watch.hpp"
#include "session/live_frames.hpp"

namespace foresight::link {

/// Of the joints that are known at that instant; `velocity` only where all of these have one. `cycle`: the newest.
JointStateMessage joint_states(const JointState& joints, const RobotCycle& cycle, const std::vector<std::string>& names,
                               RosTime stamp);
/// All but session and number. `speed`: where the gate's ramp is; `taken`: the newest set-point that it had by then.
GateMotion gate_motion(const RobotCycle& cycle, double speed, const TakenSetPoint& taken);
/// What was sent to the drives in that cycle, as one point of a trajectory; nobody drives by it.
JointTrajectory set_points(const RobotCycle& cycle, const std::vector<std::string>& names, RosTime stamp);

/// Of the links that move with the joints that are known, each from its parent link.
TFMessage link_transforms(const UrdfRobot& robot, const JointState& joints, const std::vector<std::string>& names,
                          RosTime stamp);
/// Of the robot's root in the world, and of the links that stand still on others.
TFMessage static_transforms(const UrdfRobot& robot, const Pose& T_world_robot, RosTime stamp);
/// Of the cameras in the world, at the frame's instants; empty where nobody knows.
TFMessage camera_transforms(const LiveFrame& frame, RosTime left, RosTime right);

/// All but the header's stamp, session, lenses_revision, coding and data. `joints`: names, in the rig's order.
StereoFrame stereo_frame(const LiveFrame& frame, const std::vector<std::string>& joints);
CameraInfoMessage camera_info(const Lens& lens, const std::string& frame_id, RosTime stamp);
/// Another text for every other calibration of either lens.
std::string lenses_revision(const StereoLenses& lenses);

/// All but header, session, number and cameras. `line_stopper`: of who_stopped().
RobotState robot_state(const RobotStatus& status, const Rig& rig, const std::string& line_stopper = "");
CameraLines camera_lines(const CameraLine& line, const std::string& registration, RobotTime now);
/// The same for ROS 2's tools: the robot, each drive, the cameras and the loop.
DiagnosticArray diagnostics(const RobotState& state);

/// "left_camera" and "right_camera": optical frames.
std::string camera_frame(Side side);

}  // namespace foresight::link
