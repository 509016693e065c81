#include "apps/sim_rack.hpp"

#include <cmath>

#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/yaml_fields.hpp"

namespace foresight {
namespace {

sim::NodeConfig read_drive(const YamlMap& map) {
  map.require_known({"name",
                     "kind",
                     "node",
                     "counts_per_unit",
                     "dictionary",
                     "vendor",
                     "product",
                     "revision",
                     "serial",
                     "homed",
                     "start",
                     "home",
                     "min_position",
                     "max_position",
                     "min_stop",
                     "max_stop",
                     "max_velocity",
                     "max_acceleration",
                     "inertia",
                     "load",
                     "following_error_limit",
                     "limits_off"});
  sim::NodeConfig out;
  out.name = map.text("name");
  const std::string kind = map.text("kind");
  if (kind != "cia402" && kind != "powercube")
    throw InputError(map.where("kind"), in_quotes(kind) + " is no kind of drive", "use cia402 or powercube");
  out.kind = kind == "cia402" ? sim::NodeConfig::Kind::cia402 : sim::NodeConfig::Kind::powercube;
  out.node = map.integer("node");
  const auto number = [&](const char* key, double& value) {
    if (map.has(key)) value = map.number(key);
  };
  const auto integer = [&](const char* key, std::uint32_t& value) {
    if (!map.has(key)) return;
    const double given = map.number(key);  // all 32 bits are used, which an int does not hold
    if (given < 0 || given > 4294967295.0 || given != std::floor(given))
      throw InputError(map.where(key), map.text(key) + " is no identity number",
                       "give an integer from 0 to 4294967295");
    value = static_cast<std::uint32_t>(given);
  };
  integer("vendor", out.vendor);
  integer("product", out.product);
  integer("revision", out.revision);
  integer("serial", out.serial);
  number("counts_per_unit", out.counts_per_unit);
  number("home", out.home_position);
  number("min_position", out.min_position);
  number("max_position", out.max_position);
  number("start", out.motor.start);
  number("min_stop", out.motor.min_stop);
  number("max_stop", out.motor.max_stop);
  number("max_velocity", out.motor.max_velocity);
  number("max_acceleration", out.motor.max_acceleration);
  number("inertia", out.motor.inertia);
  number("load", out.motor.load);
  number("following_error_limit", out.motor.following_error_limit);
  if (map.has("homed")) out.homed = map.integer("homed") != 0;
  if (map.has("limits_off")) out.motor.limits_off = map.integer("limits_off") != 0;
  if (map.has("dictionary")) out.dictionary = map.file().parent_path() / map.text("dictionary");
  return out;
}

}  // namespace

std::vector<sim::NodeConfig> read_rack(const std::filesystem::path& file) {
  const YamlMap map = YamlMap::load(file);
  map.require_known({"drives"});
  std::vector<sim::NodeConfig> out;
  for (const YamlMap& drive : map.maps("drives")) out.push_back(read_drive(drive));
  if (out.empty()) throw InputError(map.where("drives"), "there is no drive in it", "list at least one");
  return out;
}

}  // namespace foresight
