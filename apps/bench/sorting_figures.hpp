// How many changes of state a sorting buffer leaves.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace foresight {

/// 20,000 draws of 64 states (gl/sorting_buffer.hpp), as they come at random, some states far more often than others,
/// and object by object as from a scene: changes of state a draw with buffers of 0 to 1,024 slots by strategy, and
/// sorted as a whole. Prints them; keys: streams, each with its rows.
nlohmann::json sorting_figures(unsigned seed);

}  // namespace foresight
