// Arms that are made up on the fly, and questions for them.
#pragma once

#include <random>

#include "prediction/arm_chain.hpp"

namespace foresight {

/// The lab's own arm, up to the hand.
ArmChain lab_arm();

/// Seven joints with spherical shoulder and wrist, lying anywhere, turning either way, zero at any angle, with offsets
/// at the elbow, limits of 2 to 7 rad and now and then without. Another one for each state of `random`.
ArmChain any_spherical_arm(std::mt19937_64& random);

/// The same arm seen in a mirror.
ArmChain mirrored(const ArmChain& arm);

/// Joints uniform within the limits; a turn where there are none.
JointVector any_joints(const ArmChain& arm, std::mt19937_64& random);

/// Uniform in `low` .. `high`.
double any_number(std::mt19937_64& random, double low, double high);
Eigen::Vector3d any_direction(std::mt19937_64& random);

}  // namespace foresight
