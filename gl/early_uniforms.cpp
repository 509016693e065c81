#include "gl/early_uniforms.hpp"

#include <regex>
#include <sstream>

namespace foresight::gl {
namespace {

std::string value_of(const std::string& type, const std::string& given) {
  const auto part = [](const std::string& of) { return "min(" + of + ", " + of + ")"; };
  if (type != "mat4") return part(given);
  std::string columns;
  for (const char* column : {"[0]", "[1]", "[2]", "[3]"})
    columns += (columns.empty() ? "" : ", ") + part(given + column);
  return "mat4(" + columns + ")";
}

/// `names`: separated by commas.
std::string early_values(const std::string& type, const std::string& names) {
  static const std::regex kName(R"(\w+)");
  std::string given, early;
  for (std::sregex_iterator name(names.begin(), names.end(), kName), end; name != end; ++name) {
    const std::string of = name->str() + kAsGiven;
    given += (given.empty() ? "" : ", ") + of;
    early += " " + type + " " + name->str() + " = " + value_of(type, of) + ";";
  }
  return "uniform " + type + " " + given + ";" + early;
}

/// `count`: 0 where it is no array.
std::string early_cameras(const std::string& name, int count) {
  const std::string given = name + kAsGiven;
  if (count == 0) return "CameraBlock " + name + " = at_start(" + given + ");";
  const std::string type = "CameraBlock[" + std::to_string(count) + "]";
  std::string all;
  for (int i = 0; i < count; ++i) all += (i ? ", at_start(" : "at_start(") + given + "[" + std::to_string(i) + "])";
  return type + " " + name + " = " + type + "(" + all + ");";
}

}  // namespace

std::string with_early_uniforms(const std::string& shader) {
  static const std::regex kValues(R"(^uniform (float|int|uint|[iu]?vec[234]|mat4) (\w+(?:, \w+)*);)");
  static const std::regex kCameras(R"(^(layout\(.*\) uniform \w+ \{ CameraBlock )(\w+)(?:\[(\d+)\])?; \};)");
  std::istringstream lines(shader);
  std::string out;
  for (std::string line; std::getline(lines, line);) {
    std::smatch found;
    if (line.starts_with("uniform ") && std::regex_search(line, found, kValues)) {
      out += early_values(found[1], found[2]) + found.suffix().str();
    } else if (line.starts_with("layout(") && std::regex_search(line, found, kCameras)) {
      const int count = found[3].matched ? std::stoi(found[3]) : 0;
      out += found[1].str() + found[2].str() + kAsGiven + (count ? "[" + found[3].str() + "]" : "") + "; }; " +
             early_cameras(found[2], count) + found.suffix().str();
    } else {
      out += line;
    }
    out += "\n";
  }
  return out;
}

}  // namespace foresight::gl
