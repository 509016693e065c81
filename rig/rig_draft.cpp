#include "rig/rig_draft.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/error.hpp"
#include "common/text.hpp"
#include "rig/bus_plan.hpp"
#include "rig/home.hpp"
#include "rig/joint_groups.hpp"
#include "rig/joint_limits.hpp"
#include "scene/urdf_limits.hpp"
#include "sim/drives/homing_search.hpp"

namespace foresight {
namespace {

// What neither URDF nor data sheet tells. A first rig is slow; whoever has seen the robot move raises it.
constexpr double kFirstSpeed = 1.0;   // rad/s, at most; m/s too
constexpr double kRangeTime = 1.0;    // seconds for the whole range, at least
constexpr double kTimeToSpeed = 0.5;  // seconds: acceleration
constexpr double kTimeToAcceleration = 1. / 15;
constexpr double kLag = 0.1;               // seconds of way at full velocity: following error
constexpr double kHomingShare = 0.1;       // of the velocity
constexpr double kEndlessRange = 3.1;      // rad to each side, of a joint without limits
constexpr double kMockCounts = 2'000'000;  // per rad
constexpr double kMockCountsPerMetre = 100'000'000;
constexpr double kMetresPerTurn = 0.01;            // of a spindle of which nobody knows
constexpr double kHomeInside = 0.01;               // of the range: from its end to the home that a limit switch gives
constexpr double kRoomAtZero = 0.1;                // of the range, on both sides of a home at 0
constexpr double kLabReach = 0.9;                  // m, of an arm whose links are kept Surroundings::clearance apart
constexpr double kLeastClearance = 0.003;          // m
constexpr double kFloor = 0.1, kFloorStep = 0.01;  // m: its thickness, and how finely its place is sought
constexpr double kHangs = 0.25;  // of its reach: a robot that is so far below its foot at home hangs from there

bool moves(const UrdfJoint& joint) {
  return joint.kind != UrdfJoint::Kind::fixed && !joint.mimic;
}

void choose_limits(const UrdfJoint& from, const std::optional<DriveSheet>& sheet, const std::string& where,
                   DraftJoint& out) {
  DriveConfig& d = out.joint.drive;
  const bool turns = from.kind == UrdfJoint::Kind::rotating;
  if (!turns && !(std::isfinite(from.lower) && std::isfinite(from.upper)))
    throw InputError(where, "slides without limits", "give it a <limit lower upper>");
  if (from.lower >= from.upper)
    throw InputError(where, fmt::format("its limits are {:g} and {:g}: it cannot move", from.lower, from.upper),
                     "give it a <limit lower upper>, or make it fixed");
  d.min_position = std::isfinite(from.lower) ? from.lower : -kEndlessRange;
  d.max_position = std::isfinite(from.upper) ? from.upper : kEndlessRange;
  const double range = d.max_position - d.min_position;
  double fastest = std::min(kFirstSpeed, range / kRangeTime);
  if (from.velocity > 0) fastest = std::min(fastest, from.velocity);
  if (turns && sheet && sheet->fastest_rad_per_s) fastest = std::min(fastest, *sheet->fastest_rad_per_s);
  d.max_velocity = fastest;
  d.max_acceleration = fastest / kTimeToSpeed;
  out.joint.jerk = d.max_acceleration / kTimeToAcceleration;
  out.joint.following_error = kLag * fastest;
  d.homing_velocity = kHomingShare * fastest;
  out.urdf_says = std::isfinite(from.lower) ? "" : "continuous; ";
  out.urdf_says +=
      from.velocity > 0 ? fmt::format("{:g} {}/s", from.velocity, turns ? "rad" : "m") : std::string("no velocity");
}

void choose_scaling(const std::optional<DriveSheet>& sheet, RigJoint& joint) {
  DriveConfig& d = joint.drive;
  const bool turns = joint.unit == "rad";
  d.counts_per_unit = turns ? kMockCounts : kMockCountsPerMetre;
  if (!sheet) return;
  d.vendor = sheet->vendor;
  d.product = sheet->product;
  if (sheet->counts_per_turn)
    d.counts_per_unit = *sheet->counts_per_turn / (turns ? 2 * std::numbers::pi : kMetresPerTurn);
}

/// The method that suits: what the sheet has set, else the first of those that work from any pose.
std::optional<int> homing_method_of(const std::optional<DriveSheet>& sheet, bool home_inside) {
  constexpr std::array inside{20, 19, 22, 21, 4, 3, 6, 5, 24, 23, 25, 26, 27, 28, 29, 30, 8, 7, 9, 10, 11, 12, 13, 14};
  constexpr std::array at_ends{17, 18, 1, 2};
  const auto has = [&](int method) {
    if (!sheet || sheet->homing_methods.empty()) return true;
    return std::ranges::find(sheet->homing_methods, method) != sheet->homing_methods.end();
  };
  const auto first_of = [&](const auto& list) -> std::optional<int> {
    const auto found = std::ranges::find_if(list, has);
    if (found == list.end()) return std::nullopt;
    return *found;
  };
  if (sheet && !sheet->can_home) return std::nullopt;
  if (sheet && sheet->homing_method && has(*sheet->homing_method)) {
    const auto known = sim::homing_method(*sheet->homing_method);
    if (known && known->input != 0) return sheet->homing_method;
  }
  const auto wanted = home_inside ? first_of(inside) : first_of(at_ends);
  if (wanted) return wanted;
  return home_inside ? first_of(at_ends) : first_of(inside);
}

/// Without the last digits that sums leave: a file is read by people.
double written_plainly(double position) {
  return std::round(1e9 * position) / 1e9;
}

void choose_homing(const std::optional<DriveSheet>& sheet, RigJoint& joint) {
  DriveConfig& d = joint.drive;
  const double range = d.max_position - d.min_position;
  const bool zero_inside = d.min_position + kRoomAtZero * range < 0 && 0 < d.max_position - kRoomAtZero * range;
  const auto number = homing_method_of(sheet, joint.group != JointGroup::gripper);
  joint.absolute = !number;
  if (!number) return;
  joint.homing_method = *number;
  const auto method = sim::homing_method(*number);
  if (method->input == sim::kNegativeLimit)
    d.offset = written_plainly(d.min_position + kHomeInside * range);
  else if (method->input == sim::kPositiveLimit)
    d.offset = written_plainly(d.max_position - kHomeInside * range);
  else
    d.offset = zero_inside ? 0 : written_plainly(0.5 * (d.min_position + d.max_position));
}

/// Each drive on the first bus that has room for it.
void choose_buses(DriveProtocol protocol, RigDraft& draft) {
  Rig& rig = draft.rig;
  const auto name = [](std::size_t i) { return "bus" + std::to_string(i + 1); };
  rig.buses = {{name(0), "mock", protocol, 1'000'000}};
  for (DraftJoint& draft_joint : draft.joints) {
    draft_joint.joint.bus = rig.buses.size() - 1;
    draft_joint.joint.drive.node = static_cast<int>(rig.joints.size()) + 1;
    rig.joints.push_back(draft_joint.joint);
    if (planned_bus_load(rig, rig.buses.size() - 1) <= kMostBusLoad) continue;
    rig.buses.push_back({name(rig.buses.size()), "mock", protocol, 1'000'000});
    draft_joint.joint.bus = rig.joints.back().bus = rig.buses.size() - 1;
  }
  if (rig.buses.size() > 1)
    draft.notes.push_back(fmt::format("{} drives would fill one bus beyond {:.0f} %: they are on {}", rig.joints.size(),
                                      100 * kMostBusLoad, rig.buses.size()));
}

/// How far from its root each link's origin can be, metres; never too little.
std::vector<double> farthest_origins(const UrdfRobot& robot) {
  std::vector<double> far(robot.links.size());
  for (std::size_t i = 1; i < robot.links.size(); ++i) {
    const UrdfJoint& joint = robot.joints[i - 1];
    const double slide =
        joint.kind == UrdfJoint::Kind::sliding ? std::max(std::abs(joint.lower), std::abs(joint.upper)) : 0;
    far[i] = far[static_cast<std::size_t>(robot.links[i].parent)] + joint.T_parent_joint.translation().norm() +
             (std::isfinite(slide) ? slide : 0);
  }
  return far;
}

double radius_of(const Mesh& mesh) {
  double out = 0;
  for (const auto& v : mesh.vertices) out = std::max(out, v.cast<double>().norm());
  return out;
}

/// The same of any of its points, those that are seen and those that it is guarded by.
double reach_of(const UrdfRobot& robot) {
  const std::vector<double> far = farthest_origins(robot);
  double out = 0;
  for (std::size_t i = 0; i < robot.links.size(); ++i)
    out = std::max(out, far[i] + std::max(radius_of(robot.links[i].mesh), radius_of(robot.body(i))));
  return out;
}

/// How far the arm's last joint can be from its first, metres; never too little. 0: it has but one, or none.
double arm_reach_of(const Rig& rig) {
  const UrdfRobot& robot = *rig.robot;
  const std::vector<double> far = farthest_origins(robot);
  double first = std::numeric_limits<double>::infinity(), last = 0;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const std::string& mover = robot.joints[static_cast<std::size_t>(source_of(robot, i).joint)].name;
    const auto moves_it = [&](const RigJoint& joint) {
      return joint.group == JointGroup::arm && joint.drive.name == mover;
    };
    if (robot.joints[i].kind == UrdfJoint::Kind::fixed || std::ranges::none_of(rig.joints, moves_it)) continue;
    const double here = far[static_cast<std::size_t>(robot.joints[i].child)];
    first = std::min(first, here);
    last = std::max(last, here);
  }
  return std::max(0.0, last - first);
}

/// That of the lab's arm, less of a smaller one, in whole millimetres.
double clearance_of(const Rig& rig) {
  const double reach = arm_reach_of(rig), usual = Surroundings{}.clearance;
  const double wanted = reach > 0 ? usual * std::min(1.0, reach / kLabReach) : usual;
  return std::max(kLeastClearance, std::floor(1000 * wanted + 1e-6) / 1000);
}

double lowest_of(const Mesh& mesh) {
  double out = 0;
  for (const auto& v : mesh.vertices) out = std::min(out, static_cast<double>(v.z()));
  return out;
}

std::string too_close_at_home(RobotShape& shape, std::size_t couple, std::span<const double> home) {
  std::vector<double> margins(shape.couples());
  shape.margins(home, margins);
  const double apart = shape.kept_apart(couple) + margins[couple], leaves = std::floor(1000 * apart) / 1000;
  const std::string what = fmt::format("at home {}, {:.3f} m apart of {:.3f} m", shape.message(couple),
                                       std::max(0.0, apart), shape.kept_apart(couple));
  return what + ": the gate lets them only part, and may hold the robot as it looks for home. " +
         (leaves >= 0.001 ? fmt::format("A clearance_m of {:g} lets them be", leaves)
                          : std::string("Give these links slimmer <collision> shapes, or set the offset of a joint "
                                        "between them such that they stand clear at home"));
}

/// Floor and workspace, such that the robot stands clear at home.
void choose_surroundings(RigDraft& draft) {
  Rig& rig = draft.rig;
  const double reach = 0.05 * std::ceil((reach_of(*rig.robot) + 0.05) / 0.05);
  const JointValues stands = home_of(rig);
  const std::span home(stands.data(), rig.joints.size());
  const auto shape = rig.shape();
  rig.surroundings = {};
  rig.surroundings.clearance = clearance_of(rig);
  shape->surround(rig.surroundings);
  if (const auto couple = shape->too_close(home)) draft.warnings.push_back(too_close_at_home(*shape, *couple, home));
  const double stand = std::floor(100 * lowest_of(rig.robot->links[0].mesh) + 0.1) / 100;
  const auto put_floor = [&](double depth, double thickness) {
    const Eigen::Vector3d top(0, 0, stand - depth), far(reach, reach, 0);
    rig.surroundings.obstacles = {{"floor", {top - far - thickness * Eigen::Vector3d::UnitZ(), top + far}}};
  };
  double below = 0;  // the robot's foot
  for (; below < kHangs * reach; below += kFloorStep) {
    put_floor(below, reach);  // so thick that nothing can be below it
    shape->surround(rig.surroundings);
    const char* const what = shape->obstructed(home);
    if (what == nullptr || std::string_view(what).find("'floor'") == std::string_view::npos) break;
  }
  const bool hangs = below >= kHangs * reach;
  if (hangs) below = reach;
  put_floor(below, kFloor);
  rig.surroundings.workspace = {Eigen::Vector3d(-reach, -reach, stand - below),
                                Eigen::Vector3d(reach, reach, stand + reach)};
  if (hangs)
    draft.notes.push_back(
        fmt::format("it hangs from its foot: the floor is as far below as it reaches, {:.2f} m; robot.pose lifts it, "
                    "and obstacles take floor and ceiling where they are",
                    below));
  else if (below > 0)
    draft.notes.push_back(fmt::format(
        "the floor is {:.2f} m below the robot's foot: higher, the gate would see a moving link in it at home", below));
}

void note_left_out(const UrdfRobot& robot, RigDraft& draft) {
  for (const UrdfJoint& joint : robot.joints) {
    if (joint.mimic)
      draft.notes.push_back(fmt::format("{} follows {}: it has no drive of its own", joint.name,
                                        robot.joints[static_cast<std::size_t>(joint.mimic->joint)].name));
    if (joint.loose)
      draft.notes.push_back(joint.name +
                            " is floating or planar: it counts as fixed where the URDF has it, and has no drive");
  }
}

void note_sheet(const DriveSheet& sheet, RigDraft& draft) {
  const std::string file = sheet.file.filename().string();
  if (!sheet.counts_per_turn)
    draft.notes.push_back(file + " tells no scaling (608Fh, 6091h, 6092h): counts_per_unit is to be measured");
  if (!sheet.vendor) draft.notes.push_back(file + " tells no vendor (1018:01): any device is taken");
  for (const std::string& object : sheet.lacks) draft.notes.push_back(file + " has no " + object);
  if (!sheet.homing_methods.empty() && draft.rig.joints.front().absolute)
    draft.notes.push_back(file + " has no homing method that works from any pose: encoders are taken for absolute");
}

/// Descriptions are published without their collision meshes: the visual ones guard as well, but somebody must know.
void read_robot(const RigDraftOptions& options, RigDraft& draft) {
  MeshSearch meshes;
  meshes.root = options.mesh_root;
  try {
    draft.rig.robot = read_urdf(options.urdf, meshes, UrdfShapes::all);
  } catch (const InputError& error) {
    if (std::string_view(error.what()).find("<collision>") == std::string_view::npos) throw;
    draft.rig.robot = read_urdf(options.urdf, meshes, UrdfShapes::visual);
    draft.visual_only = true;
    const std::string why = error.what();
    draft.notes.push_back("links are guarded by their visual shapes alone (robot.shapes): " +
                          why.substr(0, why.find("; looked for")));
  }
  require_joint_units(*draft.rig.robot, options.urdf.string());
}

/// The joints within their soft limits, where these are narrower, and within what follows them.
std::vector<UrdfJoint> guarded_joints(const UrdfRobot& robot, const std::map<std::string, SoftLimits>& soft_limits) {
  UrdfRobot soft;
  soft.joints = robot.joints;
  for (UrdfJoint& joint : soft.joints) {
    const auto found = soft_limits.find(joint.name);
    if (found == soft_limits.end()) continue;
    const double lower = std::max(joint.lower, found->second.lower);
    const double upper = std::min(joint.upper, found->second.upper);
    if (lower < upper) joint.lower = lower, joint.upper = upper;
  }
  std::vector<UrdfJoint> out;
  for (std::size_t i = 0; i < soft.joints.size(); ++i) out.push_back(within_followers(soft, i));
  return out;
}

}  // namespace

RigDraft draft_rig(const RigDraftOptions& options) {
  RigDraft draft;
  read_robot(options, draft);
  const UrdfRobot& robot = *draft.rig.robot;
  draft.rig.name = robot.name.empty() ? options.urdf.stem().string() : robot.name;
  const std::vector<JointGroup> groups = guess_joint_groups(robot);
  const std::vector<UrdfJoint> guarded = guarded_joints(robot, read_soft_limits(options.urdf));
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const UrdfJoint& from = guarded[i];
    if (!moves(from)) continue;
    DraftJoint out;
    out.joint.drive.name = from.name;
    out.joint.unit = from.kind == UrdfJoint::Kind::sliding ? "m" : "rad";
    out.joint.group = groups[i];
    choose_limits(from, options.sheet, options.urdf.string() + ": joint " + in_quotes(from.name), out);
    if (from.lower > robot.joints[i].lower || from.upper < robot.joints[i].upper)
      out.urdf_says += "; narrower by soft limits, or by what follows it";
    if (options.protocol == DriveProtocol::cia402) {
      choose_scaling(options.sheet, out.joint);
      choose_homing(options.sheet, out.joint);
    }
    draft.joints.push_back(std::move(out));
  }
  if (draft.joints.empty())
    throw InputError(options.urdf.string(), "none of its joints moves on its own",
                     "make those that do revolute, continuous or prismatic, without <mimic>");
  if (draft.joints.size() > kMostJoints)
    throw InputError(options.urdf.string(), std::to_string(draft.joints.size()) + " of its joints move on their own",
                     "a rig has 1 to " + std::to_string(kMostJoints) + "; make others fixed, or split the robot");
  choose_buses(options.protocol, draft);
  note_left_out(robot, draft);
  if (options.sheet) note_sheet(*options.sheet, draft);
  choose_surroundings(draft);
  return draft;
}

}  // namespace foresight
