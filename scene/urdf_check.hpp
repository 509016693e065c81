// What a URDF says in numbers, checked before a parser sees it that passes over what it cannot read.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace foresight {

/// How many shapes a link has.
struct UrdfShapeCount {
  std::size_t visual = 0, collision = 0;
};

/// Throws InputError naming file:line, link or joint, the attribute with its value, and the cure: a <visual> or
/// <collision> that yields no shape (an unknown one, none or two, a size that is missing, no number or not above 0, a
/// mesh without a name, a scale of 0), an element of a link that is one of these misspelt, and numbers of joints that
/// are none (origin, axis, limit, mimic) or a negative velocity. `xml`: the content of `file`. The shapes by link: who
/// parses the file must find as many. Nothing is said of what is no robot at all.
std::map<std::string, UrdfShapeCount> check_urdf(const std::filesystem::path& file, const std::string& xml);

}  // namespace foresight
