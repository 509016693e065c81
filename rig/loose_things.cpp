#include "rig/loose_things.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "common/error.hpp"
#include "scene/yaml_fields.hpp"

namespace foresight {
namespace {

constexpr std::size_t kMostThings = 64;
constexpr int kTags = 587;  // of the family

double within(const YamlMap& map, const std::string& key, double least, double most, const char* what) {
  const double value = map.number(key);
  if (!(value >= least && value <= most))
    throw InputError(map.where(key), fmt::format("is {:g}, which is no {}", value, what),
                     fmt::format("choose from {:g} to {:g}", least, most));
  return value;
}

ThingTag read_tag(const YamlMap& map) {
  map.require_known({"id", "side_m", "pose"});
  ThingTag out;
  out.id = map.integer("id", 0, kTags - 1);
  out.side = within(map, "side_m", 0.005, 1, "side of a tag on a thing, metres");
  out.T_thing_tag = map.pose("pose");
  return out;
}

LooseThing read_thing(const YamlMap& map) {
  map.require_known({"node", "mass_kg", "friction", "rolling_m", "restitution", "tag"});
  LooseThing out;
  out.node = map.text("node");
  out.mass = within(map, "mass_kg", 1e-3, 100, "mass of a thing for a hand, kg");
  if (map.has("friction")) out.surface.friction = within(map, "friction", 0, 2, "friction of two surfaces");
  if (map.has("rolling_m")) out.surface.rolling = within(map, "rolling_m", 0, 0.05, "lever of rolling, metres");
  if (map.has("restitution")) out.surface.restitution = within(map, "restitution", 0, 1, "share that is thrown back");
  if (map.has("tag")) out.tag = read_tag(map.map("tag"));
  return out;
}

}  // namespace

std::vector<LooseThing> read_loose_things(const YamlMap& rig) {
  std::vector<LooseThing> out;
  if (!rig.has("things")) return out;
  const std::vector<YamlMap> things = rig.maps("things");
  if (things.size() > kMostThings)
    throw InputError(rig.where("things"), fmt::format("has {} things", things.size()),
                     fmt::format("name those that a hand takes, {} at most", kMostThings));
  for (const YamlMap& map : things) {
    LooseThing thing = read_thing(map);
    if (std::ranges::find(out, thing.node, &LooseThing::node) != out.end())
      throw InputError(map.where("node"), "'" + thing.node + "' is named twice", "name things once");
    for (const LooseThing& other : out)
      if (thing.tag && other.tag && thing.tag->id == other.tag->id)
        throw InputError(map.where("tag"), fmt::format("the tag {} is on '{}' too", thing.tag->id, other.node),
                         "give each thing a tag of its own");
    out.push_back(std::move(thing));
  }
  return out;
}

std::vector<LooseThing> loose_things(const std::filesystem::path& rig_file) {
  return read_loose_things(YamlMap::load(rig_file));
}

}  // namespace foresight
