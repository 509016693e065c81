// Lists that are written in one text.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace foresight {

/// What stands between the separators: "a,,b" has three parts, the second of them empty; "" has one, which is empty.
std::vector<std::string> split(std::string_view text, char separator);

}  // namespace foresight
