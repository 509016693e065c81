// What a user is told of the lamp.
#pragma once

#include <string>

#include "common/time.hpp"
#include "texture_gpu/lamp/lamp_search.hpp"

namespace foresight {

/// Where the lamp is, or why its shadows are not foretold; empty where nothing has told of any. `known_from`: the first
/// image with which it was known.
std::string lamp_in_words(const LampAnswer& answer, RobotTime known_from);

}  // namespace foresight
