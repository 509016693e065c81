// The gripper of a rig as what it grasps with: two jaws that slide towards each other, measured at its robot model.
//
//            T_tool_grip          x, y, z: across, the way the jaws slide, the way their tips point
//      hand ======+======
//           |jaw|   |jaw|
//           |   |<->|   |         the gap, least over `depth` from the tips on
//           '---' + '---'         its origin: between the tips
#pragma once

#include <vector>

#include "rig/rig.hpp"

namespace foresight {

/// All changes evenly with the gap, of which every joint takes its share.
struct SlidingJaws {
  struct Place {
    double gap = 0;                       ///< m between the jaws' inner faces, over `depth` from the tips on
    Pose T_tool_grip = Pose::Identity();  ///< tool: tool_link() of the rig
    std::vector<double> joints;           ///< m, of the rig's joints of `group: gripper`, in their order
  };
  Place widest, narrowest;  ///< as far as the joints' ranges let them, but for 1 % at each end
  double depth = 0;  ///< m of the jaws, from their tips on, that stand free of the hand; no more than was asked for

  /// As they are at `gap`; beyond their ranges: at their end.
  Place at(double gap) const;
};

/// Measured on links that the gripper's joints move beyond the arm's last one, by their visual shapes or else by those
/// of collision. A jaw alone closes on what the hand has beside it. Tips point along that axis of the link in which the
/// jaws slide, square to their way, on which they are farthest from the tool's origin. `depth` > 0: how much of the
/// jaws shall lie on a thing, m. Throws InputError naming the rig: no arm, no gripper, jaws that turn, that slide along
/// several lines, askew to all axes, that have no shape, or with nothing opposite, that neither open nor close.
SlidingJaws sliding_jaws(const Rig& rig, double depth);

}  // namespace foresight
