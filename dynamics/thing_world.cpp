#include "dynamics/thing_world.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"

namespace foresight {
namespace {

constexpr double kNudge = 1e-4;     // m or rad: to see what moves with a joint
constexpr double kOpposite = -0.7;  // cosine between two forces that grip
constexpr double kGripShare = 0.1;  // of the spring's force, that is a grip
constexpr double kGiveWay = 0.3;    // of the way that the spring's force lacks, each step

const Surface kFloorSurface{.friction = 0.8, .restitution = 0.3};

}  // namespace

ThingWorld::ThingWorld(const std::vector<WorldPart>& parts, PartPoses robot, ThingWorldOptions options,
                       const JointPositions& joints)
    : robot_(std::move(robot)), options_(std::move(options)), bodies_(options_.bodies) {
  for (const auto& [field, value] : {std::pair{"force", options_.jaw_force}, {"speed", options_.jaw_speed}})
    if (!(value > 0 && std::isfinite(value)))
      throw InputError(std::string("jaws: ") + field, fmt::format("{:.9g} is not positive", value), "choose more");
  for (const WorldPart& part : parts) roles_.push_back(part.role);
  const std::vector<Pose> start = robot_(joints);
  find_jaws(joints, start);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const WorldPart& part = parts[i];
    const Surface& surface = is_jaw(i) ? options_.jaw_surface : part.surface;
    switch (part.role) {
      case PartRole::still: bodies_.add_still(part.mesh, part.T_world_part, surface); break;
      case PartRole::driven: bodies_.add_driven(part.mesh, start.at(i), surface); break;
      case PartRole::loose: bodies_.add_loose(part.mesh, part.T_world_part, part.mass, part.surface); break;
    }
  }
  bodies_.add_floor(options_.floor, kFloorSurface);
}

void ThingWorld::find_jaws(const JointPositions& joints, const std::vector<Pose>& rest) {
  jaw_of_.assign(roles_.size(), -1);
  for (const std::string& name : options_.jaws) {
    const double position = joints(name).value_or(0);
    const std::vector<Pose> nudged = robot_([&](std::string_view joint) -> std::optional<double> {
      return joint == name ? position + kNudge : joints(joint);
    });
    bool any = false;
    for (std::size_t i = 0; i < roles_.size(); ++i)
      if (roles_[i] == PartRole::driven && (nudged[i].matrix() - rest[i].matrix()).norm() > 0.1 * kNudge) {
        jaw_of_[i] = static_cast<int>(jaws_.size());
        any = true;
      }
    if (!any) throw InputError("jaws: joint '" + name + "'", "moves nothing", "name a joint of the gripper");
    jaws_.push_back({name, position, position, 0, 0, 0, 0});
  }
}

JointPositions ThingWorld::with_jaws(const JointPositions& joints) const {
  return [this, &joints](std::string_view joint) -> std::optional<double> {
    for (const Jaw& jaw : jaws_)
      if (jaw.joint == joint) return jaw.position;
    return joints(joint);
  };
}

double ThingWorld::jaw_lag(std::string_view joint) const {
  for (const Jaw& jaw : jaws_)
    if (jaw.joint == joint) return jaw.position - jaw.shaft;
  return 0;
}

// The force of the last step's touches on each jaw's joint.
void ThingWorld::measure(const JointPositions& joints) {
  for (Jaw& jaw : jaws_) jaw.force = jaw.stiffness = 0;
  const auto jaw_at = [&](std::size_t body) { return body < roles_.size() ? jaw_of_[body] : -1; };
  std::vector<std::vector<Pose>> nudged(jaws_.size());
  std::vector<Pose> now;
  for (const Touch& touch : bodies_.touches())
    for (const auto& [body, sign] : {std::pair{touch.body, 1.0}, {touch.other, -1.0}}) {
      const int number = jaw_at(body);
      if (number < 0) continue;
      const auto at = static_cast<std::size_t>(number);
      if (now.empty()) now = robot_(with_jaws(joints));
      if (nudged[at].empty())
        nudged[at] = robot_([&](std::string_view joint) -> std::optional<double> {
          return joint == jaws_[at].joint ? jaws_[at].position + kNudge : with_jaws(joints)(joint);
        });
      const Eigen::Vector3d way = (nudged[at][body] * (now[body].inverse() * touch.point) - touch.point) / kNudge;
      const double along = sign * touch.normal.dot(way);
      jaws_[at].force += touch.force * along;
      jaws_[at].stiffness += options_.jaw_surface.stiffness * along * along;
    }
}

void ThingWorld::move(Jaw& jaw, double shaft) const {
  const double most = options_.jaw_speed * options_.bodies.step;
  const double free =
      std::clamp(shaft - jaw.position, std::min(-most, shaft - jaw.shaft), std::max(most, shaft - jaw.shaft));
  jaw.shaft = shaft;
  if (jaw.opening != 0) {
    const double there = jaw.position + free;
    jaw.position = jaw.opening > 0 ? std::max(there, jaw.block) : std::min(there, jaw.block);
    return;
  }
  // What resists the spring: the jaws go as far as it is stronger, and give way where it is weaker.
  const double resistance = jaw.position > shaft ? jaw.force : -jaw.force;
  if (resistance <= 0 || jaw.stiffness <= 0 || free == 0) {
    jaw.position += free;
    return;
  }
  const double room = kGiveWay * (options_.jaw_force - resistance) / jaw.stiffness;  // towards the shaft
  jaw.position += (free > 0 ? 1 : -1) * std::clamp(room, -most, std::abs(free));
}

void ThingWorld::step(const JointPositions& joints) {
  measure(joints);
  for (Jaw& jaw : jaws_)
    if (const auto shaft = joints(jaw.joint); shaft && std::isfinite(*shaft)) move(jaw, *shaft);
  const std::vector<Pose> poses = robot_(with_jaws(joints));
  for (std::size_t i = 0; i < roles_.size(); ++i)
    if (roles_[i] == PartRole::driven && poses[i].matrix().allFinite()) bodies_.place(i, poses[i]);
  bodies_.step();
}

Pose ThingWorld::grip_frame(std::size_t jaw, const JointPositions& joints) const {
  const std::vector<Pose> poses = robot_(joints);
  Pose out = Pose::Identity();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (std::size_t i = 0; i < roles_.size(); ++i) {
    if (jaw_of_[i] != static_cast<int>(jaw)) continue;
    if (count++ == 0) out = poses[i];
    sum += poses[i].translation();
  }
  out.translation() = sum / std::max(1, count);
  return out;
}

void ThingWorld::block_jaw(std::size_t number, int opening) {
  jaws_[number].opening = opening;
  jaws_[number].block = jaws_[number].position;
}

double ThingWorld::opened_by(std::size_t number) const {
  const Jaw& jaw = jaws_[number];
  return jaw.opening * (jaw.position - jaw.block);
}

int ThingWorld::gripped_by(std::size_t loose) const {
  struct Force {
    Eigen::Vector3d direction;
    double size;
    int jaw;
  };
  std::vector<Force> forces;  // on it, by the robot; no jaw's: -1
  for (const Touch& touch : bodies_.touches()) {
    const bool first = touch.body == loose;
    const std::size_t other = first ? touch.other : touch.body;
    if ((!first && touch.other != loose) || other >= roles_.size() || roles_[other] != PartRole::driven ||
        touch.force <= 0)
      continue;
    forces.push_back({first ? touch.normal : Eigen::Vector3d(-touch.normal), touch.force, jaw_of_[other]});
  }
  for (const auto& [axis, unused, jaw] : forces) {
    if (jaw < 0) continue;
    double along = 0, against = 0;
    for (const auto& [direction, force, other] : forces) {
      if (direction.dot(axis) > -kOpposite) along += force;
      if (direction.dot(axis) < kOpposite) against += force;
    }
    // Each of two jaws presses with half of the spring's force.
    if (std::min(along, against) > kGripShare * options_.jaw_force / 2) return jaw;
  }
  return -1;
}

}  // namespace foresight
