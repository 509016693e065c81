// Things that the hand has after all: they were taken for lost, or stood elsewhere when it closed around them.
#include <algorithm>
#include <cmath>

#include "prediction/grasp/thing_future.hpp"

namespace foresight {
namespace {

constexpr double kWatched = 1;         // s
constexpr double kAlong = 0.02;        // m that it goes with the hand
constexpr double kSameInHand = 0.008;  // m, at least, within which it then stays in it
constexpr double kAsBefore = 0.04;     // m: in the hand about where it was when it was lost
constexpr double kSigmas = 4;
constexpr double kCaught = 0.02;  // m beside where it was thought to stand: jaws that closed there have it, too

}  // namespace

const ThingFuture::Spell* ThingFuture::last_carried(const Thing& thing) {
  const auto held = std::find_if(thing.spells.rbegin(), thing.spells.rend(),
                                 [](const Spell& spell) { return spell.kind == Kind::carried; });
  return held == thing.spells.rend() ? nullptr : &*held;
}

/// Since they were where `joints` has them; true where that is not known.
bool ThingFuture::jaws_opened_since(std::size_t jaw, const JointPositions& joints) const {
  const std::string& joint = options_.jaws[jaw];
  const auto then = joints(joint), now = joints_now()(joint);
  return !then || !now || opening_[jaw] * (*now - *then) > kJawsOpened;
}

std::optional<Pose> ThingFuture::if_still_in_hand(std::size_t at, RobotTime time, const JointPositions& joints) const {
  const Thing& thing = things_.at(at);
  const Spell* held = last_carried(thing);
  if (!held || held == &thing.spells.back() || time < held->begin || jaws_opened_since(held->jaw, joints))
    return std::nullopt;
  return world_->grip_frame(held->jaw, joints) * held->T;
}

/// It stood a bit beside where it was thought to when the hand took it, perhaps as the hand itself had pushed it there:
/// so it is as much beside in the hand. Should it not be, what is seen next will say so. False: that is no reason.
bool ThingFuture::shift_in_hand(Thing& thing, Spell& spell, const ThingSighting& sighting) {
  Spell& held = thing.spells.back();
  if (spell.kind != Kind::rest || held.kind != Kind::carried || held.any_seen) return false;
  for (auto between = thing.spells.rbegin() + 1; &*between != &spell; ++between)
    if (between->kind != Kind::moving) return false;
  if ((sighting.T_world_thing.translation() - spell.T.translation()).norm() > kCaught) return false;
  const Pose T_world_grip = world_->grip_frame(held.jaw, world_->with_jaws(joints_at(held.begin)));
  Pose taken = T_world_grip * held.T;
  taken.translation() += sighting.T_world_thing.translation() - spell.T.translation();
  taken.linear() = sighting.T_world_thing.linear() * spell.T.linear().transpose() * taken.linear();
  spell.T = sighting.T_world_thing;
  spell.variance = sighting.sigma * sighting.sigma;
  spell.variance_rad = sighting.sigma_rad * sighting.sigma_rad;
  held.T = T_world_grip.inverse(Eigen::Isometry) * taken;
  held.variance = spell.variance + options_.grasp * options_.grasp;
  held.variance_rad = spell.variance_rad + options_.grasp_rad * options_.grasp_rad;
  thing.doubts.clear();
  place_anew(thing);
  return true;
}

/// It went along with the hand, about where the hand had it before, in all of the last sightings; and the jaws have not
/// been opened since.
bool ThingFuture::is_in_hand(Thing& thing, const ThingSighting& sighting, const JointPositions& joints) const {
  const Spell* held = last_carried(thing);
  if (!held) return false;
  const Pose T_grip_thing = world_->grip_frame(held->jaw, joints).inverse(Eigen::Isometry) * sighting.T_world_thing;
  if (!thing.seen.empty() && sighting.captured <= thing.seen.back().captured) return false;
  thing.seen.push_back({sighting.captured, sighting.T_world_thing, T_grip_thing, 0});
  while (to_seconds(sighting.captured - thing.seen.front().captured) > kWatched) thing.seen.pop_front();
  if (thing.spells.back().kind == Kind::carried) return false;
  if ((T_grip_thing.translation() - held->T.translation()).norm() > kAsBefore) return false;
  if (jaws_opened_since(held->jaw, joints)) return false;
  const double same = std::max(kSameInHand, kSigmas * sighting.sigma);
  for (auto before = thing.seen.rbegin() + 1; before != thing.seen.rend(); ++before) {
    if ((before->T_grip_thing.translation() - T_grip_thing.translation()).norm() > same) return false;
    const double along = (before->T_world_thing.translation() - sighting.T_world_thing.translation()).norm();
    if (along > kAlong + same) return true;
  }
  return false;
}

void ThingFuture::take_back(Thing& thing, const ThingSighting& sighting) {
  const std::size_t jaw = last_carried(thing)->jaw;
  const Pose T_grip_thing = thing.seen.back().T_grip_thing, before = shown(thing, model_pose(thing));
  thing.gone = false;
  thing.doubts.clear();
  thing.absences.clear();
  begin_spell(thing, Kind::carried, T_grip_thing, sighting.sigma * sighting.sigma,
              sighting.sigma_rad * sighting.sigma_rad);
  Spell& spell = thing.spells.back();
  spell.jaw = jaw;
  spell.begin = spell.seen = sighting.captured;
  spell.any_seen = true;
  world_->set_present(thing.node, true);
  world_->block_jaw(jaw, opening_[jaw]);
  world_->hold(thing.node, true);
  for (Moment& moment : thing.past)
    if (moment.time >= sighting.captured - seconds(world_->seconds_per_step())) {
      moment.spell = spell.number;
      moment.T_world_thing = world_->grip_frame(jaw, joints_at(moment.time)) * T_grip_thing;
    }
  const Pose now = world_->grip_frame(jaw, world_->with_jaws(joints_now())) * T_grip_thing;
  world_->place(thing.node, now);
  for (int k = 0; k < 3; ++k) {
    thing.place[k].forget();
    thing.turn[k].forget();
  }
  show_evenly(thing, before, now);
}

}  // namespace foresight
