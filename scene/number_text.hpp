// A number as the files of a run have it.
#pragma once

#include <charconv>
#include <string>

namespace foresight {

/// With so many digits that count, as printf's %.*g; 17 give every double back. Independent of the locale.
inline std::string number_text(double value, int digits) {
  char buffer[40];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, digits).ptr};
}

}  // namespace foresight
