// The hand of a rig: which of its joints are the arm's, which the gripper's, and where the tool is.
#pragma once

#include "input/hand_control.hpp"
#include "rig/rig.hpp"

namespace foresight {

/// The link that the rig's last arm joint moves: the farthest from the root, by drives and then by what follows them.
/// Throws InputError where two are equally far (two arms), or none of the rig's arm joints is in its URDF; the rig must
/// have one.
std::string tool_link(const Rig& rig);

/// The place between the fingers, by the link `tip`: the middle of what the rig's grippers move beyond it, with the
/// tip's axes. The tip itself where they move nothing there. A hand that turns turns the tool about it.
Pose grip_point(const Rig& rig, const std::string& tip);

/// All that HandControl needs of a rig; `tip`: the tool's link, or "" for tool_link(). The arm's base is the root link
/// of the rig's URDF, which stands at Rig::T_world_robot; the
/// tool stands at `T_tip_tool` on that link. A rig without a URDF has joints alone. Throws InputError
/// naming the rig: no such link, joints on the way to it that are not the arm's.
HandOptions hand_options(const Rig& rig, const std::string& tip = "", const Pose& T_tip_tool = Pose::Identity());

/// hand_options() with an arm. Throws InputError where the rig has none, too.
HandOptions arm_options(const Rig& rig);

}  // namespace foresight
