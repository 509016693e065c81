#include "prediction/grasp/thing_future.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error.hpp"
#include "prediction/arm_chain.hpp"

namespace foresight {
namespace {

constexpr int kGripSteps = 3;  // in a row, until a thing counts as held
constexpr double kStillSpeed = 0.01, kStillTurning = 0.15;
constexpr double kStillTime = 0.1;    // s
constexpr double kGate = 4;           // sigmas
constexpr double kGateTurned = 0.5;   // rad that nothing contradicts below
constexpr double kSamePlace = 0.006;  // m: two sightings that mean the same place
constexpr double kNewDoubt = 0.02;    // s between doubts that count
constexpr double kFarOff = 2;         // gates: no noise, whatever the place
constexpr double kTaken = 2;          // m/s: nobody takes things away faster
constexpr double kFallen = 4;         // m/s: nor do they fall faster, having fallen for 0.8 m
constexpr std::size_t kDoubtsInMotion = 3, kAbsences = 3;
constexpr double kAbsenceTime = 1;                 // s
constexpr double kLongestGap = 1;                  // s
constexpr double kFastest = 3, kFastestTurn = 20;  // m/s, rad/s: of a correction

const Surface kStill{.friction = 0.9, .restitution = 0.3};
const Surface kLink{.friction = 0.5, .restitution = 0.1, .stiffness = 3e4, .damping = 60};
constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool is_pose(const Pose& T) {
  return T.matrix().allFinite() && (T.linear() * T.linear().transpose()).isIdentity(1e-3) &&
         T.linear().determinant() > 0;
}

/// Whether a thing can have gone `way` in so many seconds, with places known to `same`.
bool may_go(const Eigen::Vector3d& way, double same, double seconds) {
  const double fallen = std::clamp(-way.z(), 0.0, kFallen * seconds);
  return way.norm() < same + std::max(kTaken * seconds, fallen);
}

Pose inverse(const Pose& T) {
  return T.inverse(Eigen::Isometry);
}

}  // namespace

const char* name_of(ThingStatus status) noexcept {
  switch (status) {
    case ThingStatus::seen: return "seen";
    case ThingStatus::carried: return "carried";
    case ThingStatus::falling: return "falling";
    case ThingStatus::predicted: return "predicted";
    case ThingStatus::unsure: return "unsure";
  }
  return "?";
}

ThingFuture::ThingFuture(const SceneModel& model, PartPoses robot, ThingFutureOptions options, RobotTime start,
                         const JointPositions& joints)
    : options_(std::move(options)), robot_(std::move(robot)), now_(start) {
  const std::vector<Pose> rest = model.rest_poses();
  std::vector<WorldPart> parts;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const Node& node = model.nodes()[i];
    parts.push_back(
        {node.mesh, node.may_move ? PartRole::driven : PartRole::still, rest[i], 0, node.may_move ? kLink : kStill});
  }
  for (const KnownThing& known : options_.things) {
    const auto node = model.find(known.node);
    if (!node) throw InputError("the thing '" + known.node + "'", "is no node of the scene", "name one of its nodes");
    WorldPart& part = parts[static_cast<std::size_t>(*node)];
    if (part.role == PartRole::loose)
      throw InputError("the thing '" + known.node + "'", "is named twice", "name things once");
    part.role = PartRole::loose;
    part.mass = known.mass;
    part.surface = known.surface;
    Thing thing;
    thing.name = known.node;
    thing.node = static_cast<std::size_t>(*node);
    things_.push_back(std::move(thing));
  }
  postures_.push_back({start, {}});
  robot_([&](std::string_view name) {  // which joints matter, in the order in which they are asked for
    if (std::ranges::find(joint_names_, name) == joint_names_.end()) {
      joint_names_.emplace_back(name);
      postures_.back().joints.push_back(joints(name).value_or(std::nan("")));
    }
    return joints(name);
  });
  ThingWorldOptions world;
  world.bodies = options_.bodies;
  world.floor = options_.floor;
  world.jaws = options_.jaws;
  world.jaw_force = options_.jaw_force;
  world_ = std::make_unique<ThingWorld>(parts, robot_, world, joints);
  opening_.assign(options_.jaws.size(), 1);
  for (Thing& thing : things_) {
    begin_spell(thing, Kind::rest, rest[thing.node], options_.model * options_.model,
                options_.model_rad * options_.model_rad);
    world_->rest(thing.node, rest[thing.node]);
    remember(thing, now_);
  }
}

JointPositions ThingFuture::joints_at(RobotTime time) const {
  const auto after = std::upper_bound(postures_.begin(), postures_.end(), time,
                                      [](RobotTime t, const Posture& posture) { return t < posture.time; });
  const Posture& posture = after == postures_.begin() ? *after : *std::prev(after);
  return [this, &posture](std::string_view name) -> std::optional<double> {
    for (std::size_t i = 0; i < joint_names_.size(); ++i)
      if (joint_names_[i] == name && std::isfinite(posture.joints[i])) return posture.joints[i];
    return std::nullopt;
  };
}

JointPositions ThingFuture::joints_now() const {
  return joints_at(postures_.back().time);
}

void ThingFuture::advance(RobotTime time, const JointPositions& joints) {
  const double gap = std::min(to_seconds(time - now_), kLongestGap);
  if (!(gap > 0)) return;
  // Steps are on a grid of their own; what is left of the gap comes with the next.
  const Duration dt = seconds(world_->seconds_per_step()), longest = seconds(kLongestGap);
  const RobotTime begin = std::max(postures_.back().time, time - longest);
  const std::vector<double> from = postures_.back().joints;
  std::vector<double> to = from;
  for (std::size_t i = 0; i < to.size(); ++i)
    if (const auto position = joints(joint_names_[i]); position && std::isfinite(*position)) to[i] = *position;
  for (RobotTime at = begin + dt; at <= time; at = at + dt) {
    const double share = to_seconds(at - begin) / to_seconds(time - begin);
    Posture posture{at, from};
    for (std::size_t i = 0; i < to.size(); ++i)
      posture.joints[i] = std::isfinite(from[i]) ? std::lerp(from[i], to[i], share) : to[i];
    postures_.push_back(std::move(posture));
    step(joints_now());
  }
  while (to_seconds(time - postures_.front().time) > kMemory && postures_.size() > 1) postures_.pop_front();
  now_ = time;
  for (Thing& thing : things_)
    for (int k = 0; k < 3; ++k) {
      thing.place[k].pass(gap, kFastest);
      thing.turn[k].pass(gap, kFastestTurn);
    }
}

void ThingFuture::step(const JointPositions& joints) {
  for (Thing& thing : things_) {
    const Spell& spell = thing.spells.back();
    if (spell.kind == Kind::carried)
      world_->place(thing.node, world_->grip_frame(spell.jaw, world_->with_jaws(joints)) * spell.T);
  }
  std::vector<Pose> before;
  for (const Thing& thing : things_) before.push_back(model_pose(thing));
  world_->step(joints);
  for (std::size_t i = 0; i < things_.size(); ++i) {
    const Thing& thing = things_[i];
    const bool still = model_pose(thing).matrix() == before[i].matrix();
    if (!still && rests(thing) && !is_touched_by_what_moves(thing)) world_->rest(thing.node, before[i]);
  }
  for (Thing& thing : things_) {
    follow(thing, joints);
    remember(thing, postures_.back().time);
  }
}

/// By the robot, by what it holds, or by what it has set moving: nothing else moves what rests. Where things are seen
/// to stand they overlap in the model, by noise or as not all of them have been seen; that pushes none of them.
bool ThingFuture::is_touched_by_what_moves(const Thing& thing) const {
  const auto moves = [this](std::size_t part) {
    if (part < world_->size() && world_->role(part) == PartRole::driven) return true;
    const auto other = std::ranges::find(things_, part, &Thing::node);
    return other != things_.end() && !rests(*other);
  };
  return std::ranges::any_of(world_->touches(), [&](const Touch& touch) {
    return touch.force > 0 &&
           ((touch.body == thing.node && moves(touch.other)) || (touch.other == thing.node && moves(touch.body)));
  });
}

/// From spell to spell.
void ThingFuture::follow(Thing& thing, const JointPositions& joints) {
  if (thing.gone) return;
  Spell& spell = thing.spells.back();
  const double dt = world_->seconds_per_step();
  if (spell.kind == Kind::carried) {
    spell.variance += options_.slip * options_.slip * dt;
    if (world_->opened_by(spell.jaw) > kJawsOpened) let_go(thing, Kind::moving, model_pose(thing));
    return;
  }
  const int jaw = world_->gripped_by(thing.node);
  thing.gripped_steps = jaw >= 0 ? thing.gripped_steps + 1 : 0;
  if (thing.gripped_steps >= kGripSteps) {
    take_along(thing, static_cast<std::size_t>(jaw), joints);
    return;
  }
  const Motion motion = world_->motion(thing.node);
  const bool still = motion.velocity.norm() < kStillSpeed && motion.turning.norm() < kStillTurning;
  thing.still_steps = still ? thing.still_steps + 1 : 0;
  if (spell.kind == Kind::rest && !still)
    begin_spell(thing, Kind::moving, motion.T_world_body, spell.variance, spell.variance_rad);
  else if (spell.kind == Kind::moving && thing.still_steps * dt >= kStillTime)
    come_to_rest(thing, motion.T_world_body);
}

/// As unsure as it has moved: what a correction or the jaws nudge has not fallen.
void ThingFuture::come_to_rest(Thing& thing, const Pose& T_world_thing) {
  const Spell& spell = thing.spells.back();
  const Vector6 moved = pose_difference(spell.T, T_world_thing);
  const double fall = std::min(options_.fall, moved.head<3>().norm());
  const double fall_rad = std::min(options_.fall_rad, moved.tail<3>().norm());
  begin_spell(thing, Kind::rest, T_world_thing, spell.variance + fall * fall, spell.variance_rad + fall_rad * fall_rad);
}

void ThingFuture::begin_spell(Thing& thing, Kind kind, const Pose& T, double variance, double variance_rad) {
  Spell spell;
  spell.number = ++spell_;
  spell.kind = kind;
  spell.T = T;
  spell.variance = variance;
  spell.variance_rad = variance_rad;
  spell.begin = postures_.back().time;
  thing.spells.push_back(spell);
  thing.gripped_steps = thing.still_steps = 0;
  while (thing.spells.size() > 1 && to_seconds(now_ - thing.spells[1].begin) > kMemory) thing.spells.pop_front();
}

void ThingFuture::take_along(Thing& thing, std::size_t jaw, const JointPositions& joints) {
  const Spell before = thing.spells.back();
  const Pose T_grip_thing = inverse(world_->grip_frame(jaw, world_->with_jaws(joints))) * model_pose(thing);
  begin_spell(thing, Kind::carried, T_grip_thing, before.variance + options_.grasp * options_.grasp,
              before.variance_rad + options_.grasp_rad * options_.grasp_rad);
  thing.spells.back().jaw = jaw;
  opening_[jaw] = world_->jaw(jaw).force >= 0 ? 1 : -1;
  world_->block_jaw(jaw, opening_[jaw]);
  world_->hold(thing.node, true);
  world_->place(thing.node, model_pose(thing));
}

void ThingFuture::let_go(Thing& thing, Kind kind, const Pose& T_world_thing) {
  const Spell before = thing.spells.back();
  if (before.kind == Kind::carried) {
    const bool alone = std::ranges::none_of(things_, [&](const Thing& other) {
      return &other != &thing && other.spells.back().kind == Kind::carried && other.spells.back().jaw == before.jaw;
    });
    if (alone) world_->block_jaw(before.jaw, 0);
  }
  world_->set_present(thing.node, true);
  world_->hold(thing.node, false);
  begin_spell(thing, kind, T_world_thing, before.variance, before.variance_rad);
}

void ThingFuture::remember(Thing& thing, RobotTime time) const {
  thing.past.push_back({time, thing.spells.back().number, model_pose(thing)});
  while (to_seconds(time - thing.past.front().time) > kMemory) thing.past.pop_front();
}

SightingResult ThingFuture::correct(const ThingSighting& sighting, const JointPositions* joints) {
  if (sighting.thing >= things_.size()) return SightingResult::not_a_thing;
  if (!is_pose(sighting.T_world_thing) || !(sighting.sigma > 0 && sighting.sigma < 1) ||
      !(sighting.sigma_rad > 0 && sighting.sigma_rad < 10))
    return SightingResult::not_a_pose;
  Thing& thing = things_[sighting.thing];
  const auto after = std::upper_bound(thing.past.begin(), thing.past.end(), sighting.captured,
                                      [](RobotTime t, const Moment& moment) { return t < moment.time; });
  if (after == thing.past.begin() || sighting.captured > now_) return SightingResult::not_known;
  const Moment& then = *std::prev(after);
  const auto spell = std::ranges::find(thing.spells, then.spell, &Spell::number);
  if (spell == thing.spells.end()) return SightingResult::not_known;
  const std::size_t jaw = spell->kind == Kind::carried ? spell->jaw : 0;
  const JointPositions then_shown = joints_at(sighting.captured);
  const JointPositions& true_joints = joints ? *joints : then_shown;
  const Pose T_world_grip = options_.jaws.empty() ? Pose::Identity() : world_->grip_frame(jaw, true_joints);
  if (is_in_hand(thing, sighting, true_joints)) {
    take_back(thing, sighting);
    return SightingResult::taken_back;
  }
  if (thing.gone) {
    put_where_seen(thing, sighting, then.spell);
    return SightingResult::moved;
  }
  const Pose expected = expected_pose(*spell, then, T_world_grip);
  const double off = gates_off(*spell, expected, sighting);
  if (off > 1) return contradict(thing, *spell, sighting, T_world_grip, off);
  if (spell->kind == Kind::moving) {
    thing.doubts.clear();
    return SightingResult::in_motion;
  }
  agree(thing, *spell, expected, sighting, T_world_grip);
  return SightingResult::taken;
}

/// Where it should have been: by all that has been learnt of its place since, or, in motion, as the model had it.
Pose ThingFuture::expected_pose(const Spell& spell, const Moment& then, const Pose& T_world_grip) {
  switch (spell.kind) {
    case Kind::rest: return spell.T;
    case Kind::carried: return T_world_grip * spell.T;
    case Kind::moving: break;
  }
  return then.T_world_thing;
}

/// By how much it is elsewhere, in place or in rotation: more than 1 contradicts. What moves may not have begun to, or
/// have gone twice as far, and how it turns nobody knows.
double ThingFuture::gates_off(const Spell& spell, const Pose& expected, const ThingSighting& sighting) const {
  const Vector6 off = pose_difference(expected, sighting.T_world_thing);
  const double sigma = std::sqrt(spell.variance + sighting.sigma * sighting.sigma);
  if (spell.kind == Kind::moving) {
    const double moved = (expected.translation() - spell.T.translation()).norm();
    const double gate = std::max(options_.least_gate, kGate * std::hypot(sigma, std::min(moved, options_.fall)));
    return off.head<3>().norm() / (gate + moved);
  }
  const double sigma_rad = std::sqrt(spell.variance_rad + sighting.sigma_rad * sighting.sigma_rad);
  return std::max(off.head<3>().norm() / std::max(options_.least_gate, kGate * sigma),
                  off.tail<3>().norm() / std::max(kGateTurned, kGate * sigma_rad));
}

/// Kalman's filter of the spell's one unknown.
void ThingFuture::agree(Thing& thing, Spell& spell, const Pose& expected, const ThingSighting& sighting,
                        const Pose& T_world_grip) {
  const Vector6 off = pose_difference(expected, sighting.T_world_thing);
  const double r = sighting.sigma * sighting.sigma, r_rad = sighting.sigma_rad * sighting.sigma_rad;
  thing.doubts.clear();
  thing.absences.clear();
  const double gain = spell.variance / (spell.variance + r),
               gain_rad = spell.variance_rad / (spell.variance_rad + r_rad);
  spell.variance *= 1 - gain;
  spell.variance_rad *= 1 - gain_rad;
  spell.seen = std::max(spell.seen, sighting.captured);
  spell.any_seen = true;
  Pose better = expected;
  better.translation() += gain * off.head<3>();
  const Eigen::Vector3d turn = gain_rad * off.tail<3>();
  if (turn.norm() > 0) better.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * expected.linear();
  spell.T = spell.kind == Kind::carried ? Pose(inverse(T_world_grip) * better) : better;
  if (&spell == &thing.spells.back()) place_anew(thing);
}

/// Where its last spell, of which more is known now, has it.
void ThingFuture::place_anew(Thing& thing) {
  const Spell& spell = thing.spells.back();
  const Pose before = model_pose(thing);
  const Pose now = spell.kind == Kind::carried
                       ? Pose(world_->grip_frame(spell.jaw, world_->with_jaws(joints_now())) * spell.T)
                       : spell.T;
  world_->rest(thing.node, now);
  show_evenly(thing, before, now);
}

/// Once may be a mistake. Twice away from the hand is lost; twice in one place is where the thing is; so is twice far
/// off, on a way that a thing can have gone in between. What is seen otherwise has to be seen a third time.
SightingResult ThingFuture::contradict(Thing& thing, Spell& spell, const ThingSighting& sighting,
                                       const Pose& T_world_grip, double gates_off) {
  if (!thing.doubts.empty() && to_seconds(sighting.captured - thing.doubts.back().captured) < kNewDoubt)
    return SightingResult::doubted;
  thing.doubts.push_back(
      {sighting.captured, sighting.T_world_thing, inverse(T_world_grip) * sighting.T_world_thing, gates_off});
  if (thing.doubts.size() < 2) return SightingResult::doubted;
  const Doubt &doubt = thing.doubts.back(), &before = thing.doubts[thing.doubts.size() - 2];
  const Eigen::Vector3d way = doubt.T_world_thing.translation() - before.T_world_thing.translation();
  const double same = std::max(kSamePlace, kGate * sighting.sigma);
  const bool moves = std::min(doubt.gates_off, before.gates_off) > kFarOff &&
                     may_go(way, same, to_seconds(doubt.captured - before.captured));
  const bool decided =
      way.norm() < same || moves || spell.kind == Kind::carried || thing.doubts.size() >= kDoubtsInMotion;
  if (!decided) return SightingResult::doubted;
  if (shift_in_hand(thing, spell, sighting)) return SightingResult::moved;
  if (spell.kind == Kind::carried || thing.spells.back().kind == Kind::carried) ++failed_;
  put_where_seen(thing, sighting, spell.number);
  return SightingResult::moved;
}

/// All that was thought of it since the spell `since` is void.
void ThingFuture::put_where_seen(Thing& thing, const ThingSighting& sighting, std::uint64_t since) {
  const Pose before = shown(thing, model_pose(thing));
  thing.gone = false;
  thing.doubts.clear();
  thing.absences.clear();
  let_go(thing, Kind::rest, sighting.T_world_thing);
  Spell& spell = thing.spells.back();
  spell.variance = sighting.sigma * sighting.sigma;
  spell.variance_rad = sighting.sigma_rad * sighting.sigma_rad;
  spell.begin = spell.seen = sighting.captured;
  spell.any_seen = true;
  for (Moment& moment : thing.past)
    if (moment.spell >= since && moment.time >= sighting.captured - seconds(world_->seconds_per_step())) {
      moment.spell = spell.number;
      moment.T_world_thing = spell.T;
    }
  world_->rest(thing.node, spell.T);
  for (int k = 0; k < 3; ++k) {
    thing.place[k].forget();
    thing.turn[k].forget();
  }
  show_evenly(thing, before, spell.T);
}

void ThingFuture::show_evenly(Thing& thing, const Pose& before, const Pose& after) const {
  const Vector6 change = pose_difference(before, after);
  for (int k = 0; k < 3; ++k) {
    thing.place[k].jumped(change[k]);
    thing.turn[k].jumped(change[3 + k]);
  }
}

void ThingFuture::absent(std::size_t at, RobotTime captured) {
  if (at >= things_.size() || captured > now_) return;
  Thing& thing = things_[at];
  if (thing.gone || (!thing.absences.empty() && captured <= thing.absences.back())) return;
  thing.absences.push_back(captured);
  while (to_seconds(captured - thing.absences.front()) > kAbsenceTime) thing.absences.pop_front();
  if (thing.absences.size() < kAbsences) return;
  if (thing.spells.back().kind == Kind::carried) ++failed_;
  const Pose there = model_pose(thing);
  let_go(thing, Kind::rest, there);
  world_->rest(thing.node, there);
  world_->set_present(thing.node, false);
  thing.gone = true;
}

Pose ThingFuture::shown(const Thing& thing, const Pose& T_world_thing) const {
  Pose out = T_world_thing;
  Eigen::Vector3d turn;
  for (int k = 0; k < 3; ++k) {
    out.translation()[k] += thing.place[k].offset();
    turn[k] = thing.turn[k].offset();
  }
  if (turn.norm() > 0) out.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * T_world_thing.linear();
  return out;
}

PredictedThing ThingFuture::thing(std::size_t at) const {
  const Thing& thing = things_.at(at);
  const Spell& spell = thing.spells.back();
  PredictedThing out;
  out.T_world_thing = shown(thing, model_pose(thing));
  out.held = spell.kind == Kind::carried;
  out.sigma = thing.gone ? kInfinity : std::sqrt(spell.variance);
  out.sigma_rad = thing.gone ? kInfinity : std::sqrt(spell.variance_rad);
  if (thing.gone || !thing.doubts.empty())
    out.status = ThingStatus::unsure;
  else if (spell.kind == Kind::carried)
    out.status = ThingStatus::carried;
  else if (spell.kind == Kind::moving)
    out.status = ThingStatus::falling;
  else
    out.status = spell.any_seen ? ThingStatus::seen : ThingStatus::predicted;
  return out;
}

std::optional<Pose> ThingFuture::at(std::size_t number, RobotTime time) const {
  const Thing& thing = things_.at(number);
  const auto after = std::upper_bound(thing.past.begin(), thing.past.end(), time,
                                      [](RobotTime t, const Moment& moment) { return t < moment.time; });
  if (after == thing.past.begin() || time > now_) return std::nullopt;
  const Moment& then = *std::prev(after);
  const auto spell = std::ranges::find(thing.spells, then.spell, &Spell::number);
  if (spell == thing.spells.end() || spell->kind == Kind::moving) return then.T_world_thing;
  return spell->kind == Kind::rest ? spell->T : Pose(world_->grip_frame(spell->jaw, joints_at(time)) * spell->T);
}

std::vector<Pose> ThingFuture::poses() const {
  const JointPositions joints = joints_now();
  std::vector<Pose> out = robot_(world_->with_jaws(joints));
  for (std::size_t i = 0; i < things_.size(); ++i) out[things_[i].node] = thing(i).T_world_thing;
  return out;
}

}  // namespace foresight
