// What the views must be before anything is solved.
#pragma once

#include "calibration/camera/rig.hpp"

namespace foresight {

inline constexpr int kFewestViews = 5;

/// Views of one camera; of a pair, those that both cameras saw.
int useful_views(const RigViews& views);

/// Guesses the size of the images where it is not known. Throws InputError: fewer than kFewestViews,
/// corners outside the image. `notes` tells the reader what was guessed, and of sizes that differ.
void check_views(RigViews& views, std::vector<std::string>& notes);

/// The smallest usual image size that holds all corners of a camera.
std::array<int, 2> usual_size(const RigViews& views, int camera);

}  // namespace foresight
