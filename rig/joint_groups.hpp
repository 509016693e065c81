// Which of a robot's joints are an arm's, which a gripper's, and which turn a camera head: guessed for a first rig,
// and to see mistakes in others.
#pragma once

#include <string>
#include <vector>

#include "rig/rig.hpp"

namespace foresight {

/// One per joint of the URDF; those that have no drive of their own count as the arm's. What is told by structure:
///
///   a gripper   ends the chain. Something follows it on the other side of the hand, or has a drive of its own there;
///               or it is alone, and the tool's frame stands beside it, or it slides a little and leads nowhere new.
///               What moves the arm by a joint that follows it (a lever beside it), or keeps its hand level, is no
///               gripper.
///   a head      two joints called pan and tilt that turn a branch of their own, with nothing that moves beyond.
///
/// An arm's last joint has the tool's frame behind it, turns far, slides far, or slides where none before it goes (a
/// gantry, a SCARA). Names decide where that leaves it open. Needs the links' shapes; reads nothing else.
std::vector<JointGroup> guess_joint_groups(const UrdfRobot& robot);

/// The joints of a rig that are in another group beyond doubt, as lines: "joint 'wrist' is in the group gripper, but
/// looks as if it belonged to arm: ...". None where the rig has no robot.
std::vector<std::string> words_on_groups(const Rig& rig);

}  // namespace foresight
