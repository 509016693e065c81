#include "apps/command_line/file_forms.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <optional>

namespace foresight {
namespace {

namespace fs = std::filesystem;

constexpr std::streamoff kSample = 4096;

/// The first and the last bytes; nothing where they cannot be read.
std::optional<std::string> sample_of(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return std::nullopt;
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  const std::streamoff size = stream.tellg();
  if (!stream) return std::nullopt;
  std::string out(static_cast<std::size_t>(std::min(size, 2 * kSample)), '\0');
  const std::streamoff first = size <= 2 * kSample ? size : kSample;
  stream.seekg(0);
  stream.read(out.data(), first);
  if (first < size) stream.seekg(size - kSample).read(out.data() + first, kSample);
  if (!stream) return std::nullopt;
  return out;
}

std::string_view without_blanks(std::string_view text) {
  return text.substr(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
}

bool holds(std::string_view text, std::string_view words) {
  const auto same = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
  };
  return !std::ranges::search(text, words, same).empty();
}

/// "KEY:" at the beginning of a line.
bool has_key(std::string_view text, std::string_view key) {
  const std::string line = std::string(key) + ":";
  return text.starts_with(line) || text.find("\n" + line) != text.npos;
}

}  // namespace

FileForm numbers_form() {
  return {"a file of numbers (JSON) of foresight",
          [](std::string_view text) { return without_blanks(text).starts_with('{') && holds(text, "\"foresight"); },
          true};
}

FileForm page_form() {
  return {"a page (HTML) of foresight",
          [](std::string_view text) { return holds(text, "<!doctype html") && holds(text, "content=\"foresight"); },
          true};
}

FileForm result_form() {
  return {
      "a result of `foresight calibrate`",
      [](std::string_view text) { return has_key(text, "kind") && has_key(text, "score") && has_key(text, "date"); },
      true};
}

FileForm camera_info_form() {
  return {"a camera_info file",
          [](std::string_view text) { return has_key(text, "camera_matrix") && has_key(text, "distortion_model"); }};
}

FileForm can_log_form() {
  return {"a log of CAN frames", [](std::string_view text) {
            text = without_blanks(text);
            return text.size() > 1 && text[0] == '(' && std::isdigit(static_cast<unsigned char>(text[1])) != 0 &&
                   text.substr(0, text.find('\n')).find('#') != text.npos;
          }};
}

FileForm joint_log_form() {
  return {"a log of joints", [](std::string_view text) { return text.starts_with("time_s,"); }};
}

FileForm board_form() {
  return {"a board (PDF) of foresight",
          [](std::string_view text) { return text.starts_with("%PDF-") && holds(text, "foresight"); }};
}

FileForm model_form() {
  return {"a model (glTF) of foresight", [](std::string_view text) {
            return (text.starts_with("glTF") || without_blanks(text).starts_with('{')) &&
                   holds(text, "\"generator\":\"foresight");
          }};
}

FileForm png_form() {
  return {"a PNG picture", [](std::string_view text) { return text.starts_with("\x89PNG\r\n\x1a\n"); }};
}

FileForm picture_form() {
  return {"a PNG or JPEG picture",
          [](std::string_view text) { return png_form().is(text) || text.starts_with("\xff\xd8\xff"); }};
}

FileForm svg_form() {
  return {"an SVG picture", [](std::string_view text) { return holds(text, "<svg"); }};
}

FileForm part_form(fs::path whole, const FileForm& form_of_whole) {
  const std::string name = "a part of " + whole.filename().string();
  return {name, [whole = std::move(whole), form = form_of_whole.is](std::string_view /*text*/) {
            const auto text = sample_of(whole);
            return text && form(*text);
          }};
}

bool has_form(const fs::path& file, const FileForm& form) {
  const auto text = sample_of(file);
  return text && (text->empty() || form.is(*text));
}

}  // namespace foresight
