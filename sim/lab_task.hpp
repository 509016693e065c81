// Things for a hand to work with, within the arm's reach on the table.
#pragma once

#include "sim/lab_builder.hpp"

namespace foresight::sim {

/// Where the things of a task stand at first, in the world.
struct TaskLayout {
  Pose brick_red, brick_blue, tray;
};
/// 0: the lab's own. Each other number gives another one, always the same: the bricks on the mat, nowhere closer to
/// each other than a hand needs, and the tray beside it; each turned about z.
TaskLayout task_layout(unsigned number);

/// Parts "brick_red" and "brick_blue", and "tray", an open box of five boards, as task_layout() has them.
void add_task_things(LabBuilder& builder, unsigned layout = 0);

/// Does what stands there stand in a tray that is there: within its walls, above its bottom?
bool lies_in_tray(const Pose& T_world_thing, const Pose& T_world_tray);

inline constexpr double kBrickSide = 0.045, kBrickHeight = 0.065;  ///< m; a brick's origin is the middle of its bottom
inline constexpr double kTraySide = 0.15, kTrayHeight = 0.05, kTrayBoard = 0.006;  ///< m, outside; of its boards

}  // namespace foresight::sim
