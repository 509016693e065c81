// Leave-one-view-out score of a hand-eye calibration.
#pragma once

#include "calibration/robot/hand_eye_problem.hpp"

namespace foresight {

/// For every used view: solves without it, from `state`, noise and lens included; predicts its
/// corners from its robot pose alone (px), and compares the board points that the robot predicts
/// with those of the view's own PnP pose, both through the lens of the other views (mm). Fills
/// loo_* of `summary` and of its views: RMS over all kept corners.
void score_left_out(const HandEyeData& data, const HandEyeSelection& selection, const HandEyeState& state,
                    HandEyeSummary& summary);

}  // namespace foresight
