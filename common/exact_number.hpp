// Numbers in files that must read back as they were.
#pragma once

#include <charconv>
#include <string>

namespace foresight {

/// The shortest decimal text that reads back as the same double ("0.1", "1e-09", "nan").
inline std::string exact_text(double value) {
  char text[32];
  return std::string(text, std::to_chars(text, text + sizeof text, value).ptr);
}

}  // namespace foresight
