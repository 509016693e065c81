#include "rig/rig.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <set>

#include "common/error.hpp"
#include "common/text.hpp"
#include "drivers/canopen/canopen_config.hpp"
#include "drivers/powercube/module.hpp"
#include "rig/bus_plan.hpp"
#include "rig/joint_limits.hpp"
#include "rig/loose_things.hpp"
#include "scene/urdf_limits.hpp"
#include "scene/yaml_fields.hpp"

namespace foresight {
namespace {

double number(const YamlMap& map, const std::string& key, double fallback) {
  return map.has(key) ? map.number(key) : fallback;
}

constexpr double kFarthest = 50;  // metres, of what stands in a lab

void require_metres(const YamlMap& map, const std::string& key, const Eigen::Vector3d& p) {
  const double most = p.cwiseAbs().maxCoeff();
  if (most <= kFarthest) return;
  throw InputError(map.where(key), fmt::format("{:g} m is farther than a lab is wide", most),
                   fmt::format("write metres; {:g} mm are {:g} m", most, 1e-3 * most));
}

Eigen::AlignedBox3d box(const YamlMap& map, const std::string& key) {
  const auto n = map.numbers(key, 6);
  require_metres(map, key, {n[0], n[1], n[2]});
  require_metres(map, key, {n[3], n[4], n[5]});
  const Eigen::Vector3d least(n[0], n[1], n[2]), most(n[3], n[4], n[5]);
  if (!(least.array() < most.array()).all())
    throw InputError(map.where(key), "has a least corner that is not below the largest",
                     "give [x, y, z of the least corner, x, y, z of the largest], metres");
  return {least, most};
}

std::optional<std::uint32_t> identity(const YamlMap& map, const std::string& key) {
  if (!map.has(key)) return std::nullopt;
  const std::string text = map.text(key);
  const bool hex = text.starts_with("0x") || text.starts_with("0X");
  std::uint32_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data() + (hex ? 2 : 0), end, value, hex ? 16 : 10);
  if (error != std::errc() || stopped != end)
    throw InputError(map.where(key), in_quotes(text) + " is no 32-bit number",
                     "give what the device reports, in decimal or as 0x and hex digits");
  return value;
}

std::filesystem::path existing_file(const YamlMap& map, const std::string& key) {
  std::filesystem::path path = map.file().parent_path() / map.text(key);
  if (!std::filesystem::is_regular_file(path))
    throw InputError(map.where(key), "there is no file " + path.string(), "give its path, relative to the rig file");
  return path;
}

/// The name of one more bus or joint.
std::string new_name(const YamlMap& map, const char* kind, const std::vector<std::string>& before) {
  std::string name = map.text("name");
  if (std::find(before.begin(), before.end(), name) != before.end())
    throw InputError(map.where("name"), std::string(kind) + " '" + name + "' is given twice", "rename or remove one");
  return name;
}

RigBus read_bus(const YamlMap& map, const std::vector<RigBus>& before) {
  map.require_known({"name", "interface", "protocol", "bit_rate"});
  std::vector<std::string> names;
  for (const RigBus& bus : before) names.push_back(bus.name);
  RigBus bus;
  bus.name = new_name(map, "bus", names);
  bus.interface = map.text("interface");
  bus.protocol = map.choice<DriveProtocol>(
      "protocol", {{"powercube", DriveProtocol::powercube}, {"cia402", DriveProtocol::cia402}});
  if (map.has("bit_rate")) bus.bit_rate = map.integer("bit_rate", 10'000, 1'000'000);
  return bus;
}

/// The joint of that name in the URDF, with what it may do for the sake of those that follow it; or nothing.
std::optional<UrdfJoint> in_urdf(const Rig& rig, const std::string& name) {
  if (!rig.robot) return std::nullopt;
  for (std::size_t i = 0; i < rig.robot->joints.size(); ++i) {
    const UrdfJoint& joint = rig.robot->joints[i];
    if (joint.name == name && joint.kind != UrdfJoint::Kind::fixed) return within_followers(*rig.robot, i);
  }
  return std::nullopt;
}

// How the joint learns where it is. "Here is home" would make the model that all checks rest on whatever the arm's
// pose is when somebody agrees to homing.
void read_reference(const YamlMap& map, bool powercube, RigJoint& joint) {
  if (powercube) {
    for (const char* key : {"homing_method", "encoder"})
      if (map.has(key))
        throw InputError(map.where(key), "is for CiA 402 only; a PowerCube module has its own way home", "remove it");
    return;
  }
  if (map.has("encoder")) joint.absolute = map.choice<bool>("encoder", {{"absolute", true}, {"incremental", false}});
  if (map.has("homing_method")) joint.homing_method = map.integer("homing_method", 1, 37);
  if (!joint.absolute && joint.homing_method == 0)
    throw InputError(map.where("encoder"), "joint '" + joint.drive.name + "' has no way to know where it is",
                     "say `encoder: absolute`, or give the homing_method of its switches");
  if (joint.absolute || joint.group == JointGroup::gripper) return;
  if (joint.homing_method == 35 || joint.homing_method == 37)
    throw InputError(map.where("homing_method"),
                     "35 and 37 take the joint's pose of the moment for home, wherever it stands",
                     "home to a switch, or use an absolute encoder");
  // The rig knows counts per unit of the joint, not how many of them the motor's turn has.
  if (joint.homing_method == 33 || joint.homing_method == 34)
    throw InputError(map.where("homing_method"),
                     "33 and 34 take the nearest index pulse for home, of whichever of the motor's turns it is",
                     "home to a switch and the index pulse beside it, 1 to 14, or use an absolute encoder");
}

// A drive may say 0 far from where its joint goes: absolute encoders where their maker put it, others by the home
// offset (607Ch) that they keep. Only emulated ones are known to keep none: they look for home at the offset.
void check_offset(const YamlMap& map, const RigBus& bus, const RigJoint& joint) {
  const DriveConfig& d = joint.drive;
  const bool turns = joint.unit == "rad";
  const double beyond = std::max({d.min_position - d.offset, d.offset - d.max_position, 0.0});
  const double most = turns ? 4 * std::numbers::pi : 10;
  const std::string range = fmt::format("{:g} to {:g} {}", d.min_position, d.max_position, joint.unit);
  if (!(beyond <= most)) {
    const double meant = d.offset * (turns ? std::numbers::pi / 180 : 1e-3);
    const bool fits = meant >= d.min_position - most && meant <= d.max_position + most;
    throw InputError(map.where("offset"),
                     fmt::format("{:g} {} is more than {} from the joint's range of {}", d.offset, joint.unit,
                                 turns ? "two turns" : "10 m", range),
                     fits ? fmt::format("{:g} looks like {}: {:.4g} {}", d.offset, turns ? "degrees" : "millimetres",
                                        meant, joint.unit)
                          : "give the joint's position where the drive says 0");
  }
  if (bus.interface == "mock" && bus.protocol == DriveProtocol::cia402 && !joint.absolute && beyond > 0)
    throw InputError(
        map.where("offset"),
        fmt::format("{:g} {} is beyond the joint's range of {}, and an emulated drive looks for home there", d.offset,
                    joint.unit, range),
        "give a position within, or say `encoder: absolute`");
}

// Slower drives than that are none that an arm follows a hand with.
constexpr double kLongestResponse = 0.5;  // s

RigJoint::Response read_response(const YamlMap& map) {
  map.require_known({"dead_time_s", "lag_s", "sigma_s"});
  const RigJoint::Response out{number(map, "dead_time_s", 0), number(map, "lag_s", 0), map.positive("sigma_s")};
  for (const auto& [key, value] :
       {std::pair{"dead_time_s", out.dead_time_s}, {"lag_s", out.lag_s}, {"sigma_s", out.sigma_s}})
    if (!(value >= 0 && value <= kLongestResponse))
      throw InputError(map.where(key), fmt::format("{:g} s is no time within which a drive follows", value),
                       fmt::format("give 0 to {:g}, in seconds", kLongestResponse));
  return out;
}

double read_start(const YamlMap& map, const RigJoint& joint) {
  const DriveConfig& d = joint.drive;
  const double start = number(map, "start", 0);
  if (!(start >= d.min_position && start <= d.max_position))
    throw InputError(map.where("start"), fmt::format("{:g} {} is beyond the joint's range", start, joint.unit),
                     fmt::format("give {:g} to {:g}", d.min_position, d.max_position));
  return start;
}

RigJoint read_joint(const YamlMap& map, const Rig& rig) {
  const std::vector<RigBus>& buses = rig.buses;
  map.require_known({"name",
                     "group",
                     "bus",
                     "node",
                     "unit",
                     "counts_per_unit",
                     "direction",
                     "offset",
                     "min",
                     "max",
                     "velocity",
                     "acceleration",
                     "jerk",
                     "following_error",
                     "homing_velocity",
                     "homing_method",
                     "encoder",
                     "vendor",
                     "product",
                     "serial",
                     "response",
                     "start"});
  RigJoint joint;
  joint.drive.name = new_name(map, "joint", rig.joint_names());
  joint.group = map.choice<JointGroup>(
      "group", {{"arm", JointGroup::arm}, {"gripper", JointGroup::gripper}, {"pan_tilt", JointGroup::pan_tilt}});
  if (!map.has("unit"))
    throw InputError(map.where("unit"), "joint '" + joint.drive.name + "' has no unit",
                     "say `unit: rad`, or `unit: m` where it slides");
  joint.unit = map.choice<std::string>("unit", {{"rad", "rad"}, {"m", "m"}});
  std::vector<std::pair<std::string, std::size_t>> names;
  for (std::size_t i = 0; i < buses.size(); ++i) names.emplace_back(buses[i].name, i);
  joint.bus = map.choice<std::size_t>("bus", names);
  const bool powercube = buses[joint.bus].protocol == DriveProtocol::powercube;
  joint.drive.node = map.integer("node", 1, powercube ? 31 : 126);
  if (powercube && map.has("counts_per_unit"))
    throw InputError(map.where("counts_per_unit"), "is not for PowerCube modules, which count in rad or m themselves",
                     "remove it");
  joint.drive.counts_per_unit = powercube ? 1 : map.positive("counts_per_unit");
  if (map.has("direction")) {
    joint.drive.direction = map.integer("direction");
    if (std::abs(joint.drive.direction) != 1)
      throw InputError(map.where("direction"), "is " + std::to_string(joint.drive.direction), "give 1 or -1");
  }
  joint.drive.offset = number(map, "offset", 0);
  const std::optional<UrdfJoint> urdf = in_urdf(rig, joint.drive.name);
  read_limits(map, urdf ? &*urdf : nullptr, rig.rate_hz, joint);
  if (!powercube) check_counts(map, joint);
  read_reference(map, powercube, joint);
  check_offset(map, buses[joint.bus], joint);
  if (map.has("start")) joint.start = read_start(map, joint);
  if (map.has("response")) joint.response = read_response(map.map("response"));
  joint.drive.vendor = identity(map, "vendor");
  joint.drive.product = identity(map, "product");
  joint.drive.serial = identity(map, "serial");
  return joint;
}

void check_joints(const YamlMap& map, const Rig& rig) {
  std::set<std::string> names;
  std::set<std::pair<std::size_t, int>> nodes;
  for (const RigJoint& joint : rig.joints) {
    names.insert(joint.drive.name);
    if (!nodes.insert({joint.bus, joint.drive.node}).second)
      throw InputError(map.where("joints"),
                       "node " + std::to_string(joint.drive.node) + " on bus '" + rig.buses[joint.bus].name +
                           "' is used twice, again by joint '" + joint.drive.name + "'",
                       "give every drive its own node id");
  }
  if (!rig.robot) return;
  std::vector<std::string> movable;
  for (const UrdfJoint& joint : rig.robot->joints)
    if (joint.kind != UrdfJoint::Kind::fixed && !joint.mimic) movable.push_back(joint.name);
  for (const RigJoint& joint : rig.joints)
    if (joint.group != JointGroup::pan_tilt &&
        std::find(movable.begin(), movable.end(), joint.drive.name) == movable.end())
      throw InputError(map.where("joints"), "joint '" + joint.drive.name + "' is none that moves in the URDF",
                       did_you_mean(joint.drive.name, movable));
  for (const std::string& name : movable)
    if (!names.contains(name))
      throw InputError(
          map.where("joints"),
          "the URDF has " + std::to_string(movable.size()) + " joints that move; '" + name + "' is not in the rig",
          "add it, or make it fixed in the URDF");
}

void read_surroundings(const YamlMap& map, Surroundings& out) {
  map.require_known({"workspace_m", "clearance_m", "obstacles"});
  if (map.has("workspace_m")) out.workspace = box(map, "workspace_m");
  if (map.has("clearance_m")) out.clearance = map.positive("clearance_m");
  require(out.clearance < 1, map.where("clearance_m"), fmt::format("is {:g} m", out.clearance),
          "choose more than 0, and less than 1");
  if (!map.has("obstacles")) return;
  for (const YamlMap& obstacle : map.maps("obstacles")) {
    obstacle.require_known({"name", "box_m"});
    out.obstacles.push_back({obstacle.has("name") ? obstacle.text("name") : "", box(obstacle, "box_m")});
  }
}

constexpr double kCycleRounding = 1e-3;  // Hz, of a cycle's nanoseconds

// As GateOptions::validate(), which knows no lines.
void read_control(const YamlMap& map, Rig& rig) {
  map.require_known({"rate_hz", "command_age_s", "feedback_age_s", "ramp_s"});
  rig.rate_hz = number(map, "rate_hz", rig.rate_hz);
  require(rig.rate_hz >= kSlowestLoopHz && rig.rate_hz <= kFastestLoopHz, map.where("rate_hz"),
          fmt::format("is {:g}", rig.rate_hz), fmt::format("choose from {:g} to {:g}", kSlowestLoopHz, kFastestLoopHz));
  const auto age = [&](const char* key, double otherwise, double most) {
    const double value = number(map, key, otherwise);
    require(value > 1 / rig.rate_hz && value <= most, map.where(key),
            fmt::format("is {:g} s, and a cycle of the control loop is {:g} s", value, 1 / rig.rate_hz),
            fmt::format("choose more than one cycle, and at most {:g} s", most));
    return value;
  };
  rig.command_age_s = age("command_age_s", rig.command_age_s, 2);
  rig.feedback_age_s = age("feedback_age_s", rig.feedback_age_s, 1);
  rig.ramp_s = number(map, "ramp_s", rig.ramp_s);
  require(rig.ramp_s >= 0 && rig.ramp_s <= 60, map.where("ramp_s"), fmt::format("is {:g} s", rig.ramp_s),
          "choose from 0 to 60");
}

/// What a bus of that protocol can be asked in: where the drives or their masters' watchdogs would not do, all commands
/// that open them would fail.
std::pair<Duration, Duration> cycles_of(DriveProtocol protocol) {
  if (protocol == DriveProtocol::powercube) return {powercube::kShortestCycle, powercube::kLongestCycle};
  const canopen::NetworkConfig usual;
  return {canopen::kShortestCycle, usual.feedback_timeout / canopen::kCyclesOfFeedback};
}

void check_rate(const YamlMap& map, const Rig& rig) {
  for (const RigBus& bus : rig.buses) {
    const auto [shortest, longest] = cycles_of(bus.protocol);
    const Duration cycle = seconds(1 / rig.rate_hz);
    require(cycle >= shortest && cycle <= longest, map.where("rate_hz"),
            fmt::format("is {:g}, and the drives of bus {} cannot be driven at that", rig.rate_hz, in_quotes(bus.name)),
            fmt::format("choose from {:.0f} to {:.0f}", std::ceil(1 / to_seconds(longest) - kCycleRounding),
                        std::min(std::floor(1 / to_seconds(shortest) + kCycleRounding), kFastestLoopHz)));
  }
}

void read_robot(const YamlMap& map, Rig& rig) {
  map.require_known({"urdf", "mesh_root", "shapes", "pose"});
  const auto urdf = existing_file(map, "urdf");
  MeshSearch meshes;
  if (map.has("mesh_root")) {
    meshes.root = map.file().parent_path() / map.text("mesh_root");
    if (!std::filesystem::is_directory(*meshes.root))
      throw InputError(map.where("mesh_root"), "there is no folder " + meshes.root->string(),
                       "give its path, relative to the rig file");
  }
  const auto shapes =
      map.has("shapes")
          ? map.choice<UrdfShapes>("shapes", {{"collision", UrdfShapes::all}, {"visual", UrdfShapes::visual}})
          : UrdfShapes::all;
  rig.robot = read_urdf(urdf, meshes, shapes);
  require_joint_units(*rig.robot, urdf.string());
  if (!map.has("pose")) return;
  rig.T_world_robot = map.pose("pose");
  require_metres(map, "pose", rig.T_world_robot.translation());
}

RigCalibration read_calibration(const YamlMap& map) {
  map.require_known({"pan_tilt", "time", "tags", "photometric"});
  const auto file = [&](const std::string& key) { return existing_file(map, key); };
  RigCalibration out;
  if (map.has("time") || !map.has("tags")) out.pan_tilt = file("pan_tilt");
  if (map.has("pan_tilt")) out.pan_tilt = file("pan_tilt");
  if (map.has("time")) out.time = file("time");
  if (map.has("tags")) out.tags = file("tags");
  if (map.has("photometric")) out.photometric = file("photometric");
  return out;
}

void require_head(const YamlMap& map, const Rig& rig) {
  const auto joints = std::count_if(rig.joints.begin(), rig.joints.end(),
                                    [](const RigJoint& joint) { return joint.group == JointGroup::pan_tilt; });
  if (joints != 2)
    throw InputError(map.where("calibration"),
                     "is that of a pan-tilt head, but " + std::to_string(joints) + " joints have the group pan_tilt",
                     "give pan and tilt, in this order, or remove the section");
}

}  // namespace

const char* to_string(JointGroup group) {
  switch (group) {
    case JointGroup::arm: return "arm";
    case JointGroup::gripper: return "gripper";
    case JointGroup::pan_tilt: return "pan_tilt";
  }
  return "?";
}

GateOptions Rig::gate_options() const {
  GateOptions out;
  out.rate_hz = rate_hz;
  out.command_age_s = command_age_s;
  out.feedback_age_s = feedback_age_s;
  out.ramp_s = ramp_s;
  out.surroundings = surroundings;
  for (const RigJoint& joint : joints)
    out.joints.push_back({joint.drive.name,
                          {joint.drive.min_position, joint.drive.max_position, joint.drive.max_velocity,
                           joint.drive.max_acceleration, joint.jerk},
                          joint.following_error,
                          joint.group == JointGroup::gripper});
  return out;
}

std::vector<std::string> Rig::joint_names() const {
  std::vector<std::string> out;
  for (const RigJoint& joint : joints) out.push_back(joint.drive.name);
  return out;
}

std::vector<JointWords> Rig::joint_words() const {
  std::vector<JointWords> out;
  for (const RigJoint& joint : joints) out.push_back({joint.drive.name, joint.unit});
  return out;
}

std::vector<std::string> Rig::urdf_joint_names() const {
  std::vector<std::string> names = joint_names();
  for (std::string& name : names)
    if (!robot || std::ranges::find(robot->joints, name, &UrdfJoint::name) == robot->joints.end()) name.clear();
  return names;
}

std::unique_ptr<RobotShape> Rig::shape() const {
  if (!robot) return nullptr;
  std::vector<bool> jaws;
  for (const RigJoint& joint : joints) jaws.push_back(joint.group == JointGroup::gripper);
  return std::make_unique<RobotShape>(*robot, urdf_joint_names(), T_world_robot, name, std::move(jaws),
                                      surroundings.clearance);
}

Rig read_rig(const std::filesystem::path& file) {
  const YamlMap map = YamlMap::load(file);
  map.require_known({"name", "robot", "control", "surroundings", "buses", "joints", "scene", "cameras", "calibration",
                     "link", "things"});
  Rig rig;
  rig.name = map.text("name");
  if (map.has("robot")) read_robot(map.map("robot"), rig);
  if (map.has("control")) read_control(map.map("control"), rig);
  if (map.has("surroundings")) read_surroundings(map.map("surroundings"), rig.surroundings);
  for (const YamlMap& bus : map.maps("buses")) rig.buses.push_back(read_bus(bus, rig.buses));
  if (map.has("control")) check_rate(map.map("control"), rig);
  for (const YamlMap& joint : map.maps("joints")) rig.joints.push_back(read_joint(joint, rig));
  check_joints(map, rig);
  if (map.has("scene")) rig.scene = existing_file(map, "scene");
  if (map.has("cameras")) rig.cameras = read_stereo_config(map.map("cameras"));
  if (map.has("calibration")) {
    rig.calibration = read_calibration(map.map("calibration"));
    if (rig.calibration->pan_tilt) require_head(map, rig);
  }
  if (map.has("link")) rig.link = read_link_config(map.map("link"));
  rig.link.where = map.where("link");
  read_loose_things(map);  // who predicts them reads them; a mistake in them is told by all commands
  rig.gate_options().validate(file.string());
  return rig;
}

}  // namespace foresight
