// Whether a rig's robot could move at all from where its joints find home.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "rig/rig.hpp"

namespace foresight {

/// Two parts that are too close for the gate: it would let them only part.
struct TooClose {
  std::string what;  ///< RobotShape::message()
  bool touch;        ///< they overlap, or the link is outside of the workspace
  std::string cure;  ///< what to do: "leave more room, or less surroundings.clearance_m: the gate lets ..."
};

/// All of them with every joint at home (home_of()). None where the rig has no robot.
std::vector<TooClose> parts_too_close_at_home(const Rig& rig);

/// The same as lines for whoever starts a program: "at home link 'hand' comes too close ...; leave more room ...".
std::vector<std::string> words_on_home(std::span<const TooClose> all);

}  // namespace foresight
