// The look of the arm: covers with rings and labels, joint caps, a gripper.
#pragma once

#include "sim/lab_builder.hpp"

namespace foresight::sim {

/// Adds the stand and the links of sim/arm.hpp, in their order, as parts; all but the stand move.
void add_arm(LabBuilder& builder);

}  // namespace foresight::sim
