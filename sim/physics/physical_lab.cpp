#include "sim/physics/physical_lab.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/error.hpp"
#include "sim/evenly.hpp"

namespace foresight::sim {
namespace {

constexpr double kSettling = 1;  // s, before the start

void check(const char* field, double value, double most) {
  if (!(value >= 0 && value <= most))
    throw InputError(std::string("hidden ") + field, fmt::format("{:.9g} is outside 0 .. {:.9g}", value, most),
                     "choose a value inside");
}

void check(const HiddenPhysics& hidden) {
  check("mass", hidden.mass, 0.9);
  check("friction", hidden.friction, 0.9);
  check("place_m", hidden.place_m, 0.05);
  check("turn_rad", hidden.turn_rad, 3.2);
}

Pose moved(const Motion& motion, double seconds) {
  Pose out = motion.T_world_body;
  out.pretranslate(seconds * motion.velocity);
  const double angle = seconds * motion.turning.norm();
  if (angle > 0) out.linear() = Eigen::AngleAxisd(angle, motion.turning.normalized()) * motion.T_world_body.linear();
  return out;
}

WorldPart loose_part(const Part& part, const LooseThing& thing, const HiddenPhysics& hidden, std::mt19937& random) {
  WorldPart out{mesh_of(part), PartRole::loose, part.T_world_part, thing.mass, thing.surface};
  out.mass *= 1 + evenly(random, hidden.mass);
  out.surface.friction *= 1 + evenly(random, hidden.friction);
  const double x = evenly(random, hidden.place_m), y = evenly(random, hidden.place_m);
  out.T_world_part.pretranslate(Eigen::Vector3d(x, y, 0));
  out.T_world_part.linear() =
      Eigen::AngleAxisd(evenly(random, hidden.turn_rad), Eigen::Vector3d::UnitZ()) * out.T_world_part.linear();
  return out;
}

}  // namespace

PhysicalLab::PhysicalLab(std::shared_ptr<const LiveLab> lab, ShaftsAt shafts, RobotTime start,
                         const PhysicsOptions& options)
    : lab_(std::move(lab)), shafts_(std::move(shafts)), start_(start), jaws_(options.jaws) {
  check(options.hidden);
  std::mt19937 random(options.hidden.seed);
  std::vector<WorldPart> parts;
  for (std::size_t i = 0; i < lab_->lab().parts.size(); ++i) {
    const Part& part = lab_->lab().parts[i];
    const auto thing = std::ranges::find(options.things, part.name, &LooseThing::name);
    if (thing != options.things.end()) {
      if (!lab_->is_loose(i))
        throw InputError("the physical lab", "has a thing '" + part.name + "' that the lab takes for fixed",
                         "name it in LiveLab::Options::loose");
      parts.push_back(loose_part(part, *thing, options.hidden, random));
      things_.push_back({i, part.name});
    } else if (part.moves && !lab_->is_loose(i)) {
      parts.push_back({mesh_of(part), PartRole::driven, part.T_world_part, 0, link_surface()});
    } else {
      parts.push_back({mesh_of(part), PartRole::still, part.T_world_part, 0, still_surface()});
    }
  }
  const auto robot = [world = lab_](const JointPositions& joints) { return world->true_state(joints, 0); };
  ThingWorldOptions world;
  world.bodies = options.bodies;
  world.jaws = options.jaws;
  world.jaw_force = options.jaw_force;
  world.jaw_surface = jaw_surface();
  const ShaftPositions at_start = shafts_at(start_);
  world_ = std::make_unique<ThingWorld>(parts, robot, world, at_start);
  for (int i = 0; i < kSettling / world_->seconds_per_step(); ++i) world_->step(at_start);
  remember(start_);
}

ShaftPositions PhysicalLab::shafts_at(RobotTime time) const {
  return [this, time](std::string_view joint) { return shafts_(joint, time); };
}

void PhysicalLab::remember(RobotTime time) {
  Instant now{time, {}, {}};
  for (const Thing& thing : things_) now.things.push_back(world_->motion(thing.part));
  for (const std::string& jaw : jaws_) now.lags.emplace_back(jaw, world_->jaw_lag(jaw));
  past_.push_back(std::move(now));
  while (past_.front().time < time - kRemembered) past_.pop_front();
}

// To the last step that is not after `time`: shafts are never asked for what is still to come.
void PhysicalLab::advance(RobotTime time) {
  const Duration step = seconds(world_->seconds_per_step());
  const std::int64_t until = (time - start_) / step;
  steps_ = std::max(steps_, until - kRemembered / step);
  while (steps_ < until) {
    const RobotTime now = start_ + ++steps_ * step;
    world_->step(shafts_at(now));
    remember(now);
  }
}

const PhysicalLab::Instant& PhysicalLab::before(RobotTime time) const {
  const auto after = std::upper_bound(past_.begin(), past_.end(), time,
                                      [](RobotTime t, const Instant& instant) { return t < instant.time; });
  return after == past_.begin() ? *after : *std::prev(after);
}

LabState PhysicalLab::state_at(RobotTime time) {
  const std::lock_guard lock(mutex_);
  advance(time);
  const Instant& instant = before(time);
  const ShaftPositions shafts = shafts_at(time);
  LabState state = lab_->true_state(
      [&](std::string_view joint) {
        std::optional<double> position = shafts(joint);
        for (const auto& [jaw, lag] : instant.lags)
          if (jaw == joint && position) *position += lag;
        return position;
      },
      to_seconds(time - start_));
  const double late = std::max(0.0, to_seconds(time - instant.time));
  for (std::size_t i = 0; i < things_.size(); ++i) state[things_[i].part] = moved(instant.things[i], late);
  return state;
}

const PhysicalLab::Thing& PhysicalLab::find(const std::string& name) const {
  const auto at = std::ranges::find(things_, name, &Thing::name);
  if (at == things_.end()) throw std::out_of_range("the physical lab has no thing " + name);
  return *at;
}

Pose PhysicalLab::thing_at(const std::string& name, RobotTime time) {
  const Thing& thing = find(name);
  const std::lock_guard lock(mutex_);
  advance(time);
  const Instant& instant = before(time);
  return moved(instant.things[static_cast<std::size_t>(&thing - things_.data())],
               std::max(0.0, to_seconds(time - instant.time)));
}

bool PhysicalLab::gripped(const std::string& name) const {
  const Thing& thing = find(name);
  const std::lock_guard lock(mutex_);
  return world_->gripped(thing.part);
}

double PhysicalLab::jaw_lag(std::string_view joint) const {
  const std::lock_guard lock(mutex_);
  return world_->jaw_lag(joint);
}

void PhysicalLab::displace(const std::string& name, const Pose& T_world_thing) {
  const Thing& thing = find(name);
  const std::lock_guard lock(mutex_);
  world_->put(thing.part, {T_world_thing, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
}

}  // namespace foresight::sim
