#include "apps/command_line/picture_size.hpp"

#include <charconv>

namespace foresight {

std::optional<std::array<int, 2>> parse_picture_size(std::string_view text) {
  std::array<int, 2> out{};
  const char* const end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, out[0]);
  if (width.ec != std::errc() || width.ptr == end || *width.ptr != 'x') return std::nullopt;
  const auto height = std::from_chars(width.ptr + 1, end, out[1]);
  if (height.ec != std::errc() || height.ptr != end) return std::nullopt;
  return out;
}

}  // namespace foresight
