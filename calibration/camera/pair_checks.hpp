// What can be wrong with the views before anything is solved together: a board seen reversed or
// mirrored, and pairs that do not belong together.
#pragma once

#include "calibration/camera/rig_solver.hpp"

namespace foresight {

struct ViewRepairs {
  std::vector<std::string> turned;   ///< views whose board was seen reversed by one camera; turned by 180 degrees
  std::vector<std::string> dropped;  ///< views that fit no others; with the reason
};

/// Looks at the orientation of every board. Drops views whose board runs the other way round than in
/// most. Throws InputError where one camera of a pair sees all boards mirrored.
void check_orientation(RigViews& views, ViewRepairs& repairs);

/// Looks whether one place of the right camera explains all pairs, from the two cameras solved alone
/// (views as views_of() gives them). Turns a board that one camera saw reversed (relabels its points
/// in the right image) and drops pairs that fit no others. Throws InputError: pairs shifted by one,
/// one camera mirrored, no place explains even half of the pairs.
void check_pairs(RigViews& views, const RigSolution& left, const RigSolution& right, ViewRepairs& repairs);

}  // namespace foresight
