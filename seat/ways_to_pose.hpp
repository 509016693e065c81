// How else an arm's joints may stand for a pose: what is found first may have the forearm at the upper arm.
#pragma once

#include <random>
#include <vector>

#include "prediction/inverse_kinematics.hpp"

namespace foresight {

/// Positions all over the ranges but for their ends; of a turning joint half a turn to each side of the middle at most.
JointVector any_joints(const ArmChain& chain, std::mt19937& random);

/// Joints at which the tip is at `T_base_tip`, for IkStatus::solved: those near `first`, then those near other
/// positions, which `random` draws; `tries` in all. None is there twice.
std::vector<JointVector> ways_to_pose(const InverseKinematics& kinematics, const Pose& T_base_tip,
                                      const JointVector& first, int tries, std::mt19937& random);

}  // namespace foresight
