// The rig file's section `things:` what about the robot is loose, so that a hand may take it along.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibration/tags/thing_tag.hpp"
#include "dynamics/body_world.hpp"

namespace foresight {

class YamlMap;

struct LooseThing {
  std::string node;  ///< of the rig's scene
  double mass = 0;   ///< kg, > 0
  Surface surface;
  std::optional<ThingTag> tag = {};
};

/// None where the file has no such section. Throws InputError naming file, line and field: a number out of range, a
/// thing or a tag named twice, and what is no rig file at all.
std::vector<LooseThing> loose_things(const std::filesystem::path& rig_file);
/// The same of the file's outermost mapping.
std::vector<LooseThing> read_loose_things(const YamlMap& rig);

}  // namespace foresight
