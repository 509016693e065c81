// What the views must be before anything is solved.
#pragma once

#include "calibration/camera/rig.hpp"

namespace foresight {

inline constexpr int kFewestViews = 5;

/// Views of one camera; of a pair, those that both cameras saw.
int useful_views(const RigViews& views);

/// Guesses the size of the images where it is not known, and takes out single corners outside of it.
/// Throws InputError: fewer than kFewestViews; more than 1 % of a camera's corners outside the image,
/// or over 5 % (3 at least) of one view's. `notes` tells the reader what was guessed and taken out, and
/// of sizes that differ.
void check_views(RigViews& views, std::vector<std::string>& notes);

/// The smallest usual image size that holds all corners of a camera but the farthest 0.1 % (one at
/// least) to the right and below, which may be wrong.
std::array<int, 2> usual_size(const RigViews& views, int camera);

}  // namespace foresight
