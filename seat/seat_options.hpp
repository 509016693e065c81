// How a seat introduces itself at a rig's line.
#pragma once

#include "link/operator_side/operator_end.hpp"
#include "rig/rig.hpp"
#include "session/live_scene.hpp"

namespace foresight {

/// `identity`: rig_identity() with the operator's name. Sizes of images are those that `scene`'s lenses belong to. On a
/// line whose round trip the rig allows for, older states of the robot count as seen.
link::OperatorEndOptions seat_end_options(const Rig& rig, Identity identity, const LiveScene& scene);

}  // namespace foresight
