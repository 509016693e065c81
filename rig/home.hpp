// Where a rig's joints stand once they have looked for home.
#pragma once

#include "motion/gate_options.hpp"
#include "rig/rig.hpp"

namespace foresight {

/// One joint; rad or m, within its range. A CiA 402 drive with an incremental encoder says 0 at the home that it finds,
/// which is the joint's `offset`. An absolute encoder looks for none: its 0 is where its maker put it, so that `offset`
/// says nothing of where the joint stands, and a PowerCube module has its own home. These count as at the joint's 0,
/// or in the middle of a range without it: there emulated ones begin, and have home.
double home_of(const RigJoint& joint, DriveProtocol protocol);

/// All joints, in the order of the rig.
JointValues home_of(const Rig& rig);

}  // namespace foresight
