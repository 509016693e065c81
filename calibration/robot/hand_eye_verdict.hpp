// What speaks against a hand-eye: robot poses of other images, turns that were missing, errors that no noise explains.
#pragma once

#include "calibration/robot/hand_eye.hpp"

namespace foresight {

/// Views whose robot pose lies so far from where the closed form has it that it cannot belong to the image; fewer than
/// half of them. `misfits_m`: HandEyeStart::misfits_m.
std::vector<bool> belong_together(const std::vector<double>& misfits_m);

/// Fills summary.verdict, and notes that name each view that is left out and by how much it contradicts the others.
/// `data` with the corners in the order that the solver found. Reads everything else of `summary`.
void judge_hand_eye(const HandEyeData& data, HandEyeSummary& summary);

/// The same where the adjustment ended with `why`. Reads mount, start and camera of `summary`.
void judge_unsolved(const HandEyeData& data, const std::string& why, HandEyeSummary& summary);

}  // namespace foresight
