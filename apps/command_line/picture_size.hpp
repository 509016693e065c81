// Sizes of pictures in a command line.
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace foresight {

/// Of "WIDTHxHEIGHT" both, px; nothing where that is anything else, or beyond an int. Which sizes make sense is for the
/// command to say.
std::optional<std::array<int, 2>> parse_picture_size(std::string_view text);

/// Of --size, likewise: InputError where either lies beyond `least` or `most`, or there is no size.
std::array<int, 2> size_option(std::string_view text, std::array<int, 2> least, std::array<int, 2> most);

}  // namespace foresight
