#include "apps/command_line/picture_size.hpp"

#include <charconv>

#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

std::string size_text(const std::array<int, 2>& size) {
  return std::to_string(size[0]) + "x" + std::to_string(size[1]);
}

}  // namespace

std::optional<std::array<int, 2>> parse_picture_size(std::string_view text) {
  std::array<int, 2> out{};
  const char* const end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, out[0]);
  if (width.ec != std::errc() || width.ptr == end || *width.ptr != 'x') return std::nullopt;
  const auto height = std::from_chars(width.ptr + 1, end, out[1]);
  if (height.ec != std::errc() || height.ptr != end) return std::nullopt;
  return out;
}

std::array<int, 2> size_option(std::string_view text, std::array<int, 2> least, std::array<int, 2> most) {
  const auto size = parse_picture_size(text);
  const auto fits = [&](std::size_t i) { return (*size)[i] >= least[i] && (*size)[i] <= most[i]; };
  require(size && fits(0) && fits(1), "--size", in_quotes(text) + " is no size",
          "write WIDTHxHEIGHT in px, from " + size_text(least) + " to " + size_text(most));
  return *size;
}

}  // namespace foresight
