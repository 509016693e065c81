// How alike two words are.
#pragma once

#include <cstddef>
#include <string_view>

namespace foresight {

/// How many letters must be put in, taken out or exchanged to make one of the other; of `word`, the first 64 count.
std::size_t edit_distance(std::string_view word, std::string_view other);

}  // namespace foresight
