// Things for a hand to work with, within the arm's reach on the table.
#pragma once

#include "sim/lab_builder.hpp"

namespace foresight::sim {

/// Parts "brick_red" and "brick_blue", on the mat, and "tray", an open box of five boards beside it.
void add_task_things(LabBuilder& builder);

inline constexpr double kBrickSide = 0.045, kBrickHeight = 0.065;  ///< m; a brick's origin is the middle of its bottom
inline constexpr double kTraySide = 0.15, kTrayHeight = 0.05, kTrayBoard = 0.006;  ///< m, outside; of its boards

}  // namespace foresight::sim
