// Counts in sentences.
#pragma once

#include <concepts>
#include <string>
#include <string_view>

namespace foresight {

/// "1 view", "3 views"; `more`: the plural where an "s" does not make it.
template <std::integral Count>
std::string counted(Count count, std::string_view one, std::string_view more = {}) {
  std::string out = std::to_string(count) + " ";
  if (count == 1 || !more.empty()) return out.append(count == 1 ? one : more);
  return out.append(one) + "s";
}

}  // namespace foresight
