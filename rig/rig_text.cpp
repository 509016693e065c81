// The rig file that a draft becomes: every number with its reason.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/text.hpp"
#include "rig/bus_plan.hpp"
#include "rig/rig_draft.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

/// As YAML reads it back: plain where it is a plain word, else in double quotes.
std::string scalar(const std::string& text) {
  const auto plain = [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '.' || c == '/' || c == '-'; };
  const bool word =
      !text.empty() && std::isalpha(static_cast<unsigned char>(text.front())) && std::ranges::all_of(text, plain);
  // Words that YAML takes for something else.
  static const std::vector<std::string> kTaken{"null", "true", "false", "yes", "no", "on", "off", "y", "n"};
  if ((word || text.starts_with("../")) && std::ranges::all_of(text, plain) &&
      std::ranges::find(kTaken, lower(text)) == kTaken.end())
    return text;
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

/// With all digits, and no ".0".
std::string exact(double value) {
  std::string out = fmt::format("{}", value);
  if (out.ends_with(".0")) out.resize(out.size() - 2);
  return out;
}

std::string box(const Eigen::AlignedBox3d& b) {
  const auto number = [](double value) { return fmt::format("{:g}", std::round(1000 * value) / 1000 + 0.0); };
  std::string out;
  for (const Eigen::Vector3d& corner : {Eigen::Vector3d(b.min()), Eigen::Vector3d(b.max())})
    for (const double value : corner) out += (out.empty() ? "[" : ", ") + number(value);
  return out + "]";
}

std::string path_from(const fs::path& file, const fs::path& target) {
  const fs::path folder = fs::weakly_canonical(fs::absolute(file)).parent_path();
  const fs::path whole = fs::weakly_canonical(fs::absolute(target)), relative = whole.lexically_relative(folder);
  return scalar((relative.empty() ? whole : relative).string());
}

std::string heading(const RigDraft& draft, const RigDraftOptions& options) {
  std::string out = fmt::format(
      "# {}: made of {} by `foresight rig new`, for mock drives and mock cameras.\n"
      "# docs/rig-files.md explains every key; docs/own-robot.md is the way from here to the real robot. All numbers "
      "of a\n"
      "# joint are in its unit, rad or m, and per second where they are speeds.\n",
      draft.rig.name, options.urdf.filename().string());
  for (const std::string& warning : draft.warnings) out += "# Warning: " + warning + ".\n";
  for (const std::string& note : draft.notes) out += "# Note: " + note + ".\n";
  return out;
}

std::string surroundings_text(const Surroundings& surroundings) {
  std::string out =
      "surroundings:\n"
      "  # As far as any part of the robot can reach. Make it as small as the work allows: links never leave it.\n"
      "  workspace_m: " +
      box(surroundings.workspace) + "\n" +
      fmt::format("  clearance_m: {:g}  # kept from obstacles and between links; 0.02 of an arm of 0.9 m or more\n",
                  surroundings.clearance) +
      "  # Add what stands around the robot: tables, walls, the stand of the cameras.\n"
      "  obstacles:\n";
  for (const Obstacle& obstacle : surroundings.obstacles)
    out += "    - {name: " + scalar(obstacle.name) + ", box_m: " + box(obstacle.box) + "}\n";
  return out;
}

std::string buses_text(const Rig& rig) {
  std::string out = "buses:  # for real drives, `interface: can0` and so on in place of `mock`\n";
  for (std::size_t i = 0; i < rig.buses.size(); ++i) {
    const RigBus& bus = rig.buses[i];
    const auto drives = std::ranges::count_if(rig.joints, [&](const RigJoint& joint) { return joint.bus == i; });
    out += fmt::format(
        "  - {{name: {}, interface: {}, protocol: {}, bit_rate: {}}}  # {} drive{} at {:g} Hz: {:.0f} % of "
        "it, at most {:.0f} % are allowed\n",
        bus.name, bus.interface, bus.protocol == DriveProtocol::cia402 ? "cia402" : "powercube", bus.bit_rate, drives,
        drives == 1 ? "" : "s", rig.rate_hz, 100 * planned_bus_load(rig, i), 100 * kMostBusLoad);
  }
  return out;
}

std::string reasons(const RigDraftOptions& options) {
  std::string out =
      "joints:\n"
      "  # In the URDF's order, which is that of commands. Nodes are counted through; set the drives' own, or correct "
      "them.\n"
      "  # min, max: the URDF's limits, or narrower ones of its <safety_controller> or of what follows the joint; of "
      "an\n"
      "  # endless joint, 3.1 rad to each side, for the sake of cables.\n"
      "  # velocity: the URDF's, at most 1 rad/s or 1 m/s, and 1 s for the whole range: a first rig is slow. Raise it "
      "later.\n"
      "  # acceleration: full speed in 0.5 s. jerk: full acceleration in 1/15 s.\n"
      "  # following_error: the way of 0.1 s at full speed. Drives lag a few cycles; more is a joint that does not "
      "follow.\n";
  if (options.protocol == DriveProtocol::powercube)
    return out + "  # PowerCube modules know their own scaling and their own way home.\n";
  const bool scaled = options.sheet && options.sheet->counts_per_turn;
  out +=
      scaled
          ? "  # counts_per_unit: " + options.sheet->scaling +
                (options.sheet->scaling.starts_with("6092h") ? "" : ", per turn of the joint") +
                "; what slides is taken to go 0.01 m a turn: check it.\n"
          : std::string(
                "  # counts_per_unit: that of mock drives, 2,000,000 per rad and 100 per um. Real: increments of the "
                "encoder per turn of\n  # the motor (608Fh) x gear (6091h) / 6.2831853 rad.\n");
  out +=
      "  # direction: -1 where the motor turns against the joint. offset: the joint's position where the drive says 0: "
      "at\n"
      "  # home, as long as its home offset (607Ch) is 0.\n"
      "  # homing_method: how the drive finds home (6098h). 19 to 22: a switch that is closed from home to one end, "
      "from any\n"
      "  # pose, here at 0 or, where 0 is near an end or beyond, in the middle; 17, 18: the limit switch at the lower, "
      "upper\n"
      "  # end, here 1 % of the range inside. Where the encoder knows its position from power-on: `encoder: absolute`, "
      "without\n"
      "  # homing_method. homing_velocity: a tenth of velocity.\n";
  return out;
}

std::string joint_text(const DraftJoint& draft, const Rig& rig, const RigDraftOptions& options) {
  const RigJoint& joint = draft.joint;
  const DriveConfig& d = joint.drive;
  std::string out = fmt::format("  - {{name: {}, group: {}, bus: {}, node: {}, unit: {},\n", scalar(d.name),
                                to_string(joint.group), rig.buses[joint.bus].name, d.node, joint.unit);
  const auto number = [](double value) { return fmt::format("{:.6g}", value); };
  if (options.protocol == DriveProtocol::cia402) {
    out +=
        fmt::format("     counts_per_unit: {}, direction: 1, offset: {}, ", exact(d.counts_per_unit), exact(d.offset));
    out += joint.absolute ? "encoder: absolute,\n"
                          : fmt::format("encoder: incremental, homing_method: {}, homing_velocity: {},\n",
                                        joint.homing_method, number(d.homing_velocity));
    if (d.vendor) out += fmt::format("     vendor: 0x{:X},", *d.vendor);
    if (d.product) out += fmt::format("{}product: 0x{:X},", d.vendor ? " " : "     ", *d.product);
    if (d.vendor || d.product) out += "\n";
  } else {
    out += fmt::format("     direction: 1, offset: 0, homing_velocity: {},\n", number(d.homing_velocity));
  }
  return out + fmt::format(
                   "     min: {}, max: {}, velocity: {}, acceleration: {}, jerk: {}, following_error: {}}}"
                   "  # URDF: {}\n",
                   d.min_position, d.max_position, exact(d.max_velocity), number(d.max_acceleration),
                   number(joint.jerk), number(joint.following_error), draft.urdf_says);
}

}  // namespace

std::string rig_text(const RigDraft& draft, const RigDraftOptions& options, const fs::path& file) {
  const Rig& rig = draft.rig;
  std::string out = heading(draft, options) + "name: " + scalar(rig.name) +
                    "\nrobot:\n  urdf: " + path_from(file, options.urdf) + "\n";
  if (draft.visual_only)
    out += "  shapes: visual  # its collision meshes are not there; give them, and remove this line\n";
  if (options.mesh_root) out += "  mesh_root: " + path_from(file, *options.mesh_root) + "\n";
  out +=
      "  # Where its root stands in the world: x forward from the operator, y left, z up. Measure it.\n"
      "  pose: {xyz: [0, 0, 0], quaternion: [0, 0, 0, 1]}\n"
      "# A command that is older than command_age_s counts as none, a position older than feedback_age_s stops the "
      "robot;\n"
      "# after each start, full speed comes after ramp_s.\n" +
      fmt::format("control: {{rate_hz: {:g}, command_age_s: {:g}, feedback_age_s: {:g}, ramp_s: {:g}}}\n", rig.rate_hz,
                  rig.command_age_s, rig.feedback_age_s, rig.ramp_s);
  out += surroundings_text(rig.surroundings) + buses_text(rig);
  out +=
      "cameras:  # `driver: v4l2` and `serial:`, or libcamera, in place of `mock` take the picture of real ones\n"
      "  pairing_tolerance_s: 0.008\n"
      "  left: {driver: mock, size_px: [320, 240], rate_hz: 10, exposure_s: 0.008}\n"
      "  right: {driver: mock, size_px: [320, 240], rate_hz: 10, exposure_s: 0.008}\n"
      "link:\n"
      "  domain: 0  # of robots that share a network or a host, each has its own; docs/line.md\n";
  out += reasons(options);
  for (const DraftJoint& joint : draft.joints) out += joint_text(joint, rig, options);
  return out;
}

}  // namespace foresight
