// A scripted hand that goes from place to place where its arm can.
#pragma once

#include <vector>

#include "seat/tool_script.hpp"

namespace foresight {

/// A tour of at most `count` poses, by `seed`: before the arm, above what lies in its reach, the tool pointing down.
/// How far away and how high follows from the arm's reach, and from where its first axis stands; below it where the arm
/// hangs. Where the joints that are found first for a pose are not clear, others are; an arm that is near itself
/// wherever it stands keeps less room beyond the rig's clearance, never less than that. Where it hardly gets to any of
/// them (a SCARA, a gantry, an arm on a wall), the tour is one of joints: wherever the arm stands clear, and so on the
/// way there. Throws InputError: no arm, or none that is clear.
std::vector<ToolStep> tour(const Rig& rig, unsigned seed, int count);

/// A rig that names no start position gets one: of its arm, in the middle of where tours go, and clear all the way from
/// home. Where there is none such, or no arm, it stays without.
void give_start(Rig& rig);

}  // namespace foresight
