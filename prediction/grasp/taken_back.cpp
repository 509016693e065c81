// Things that were taken for lost, and that the hand has after all.
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

}  // namespace

/// It went along with the hand, about where the hand had it before, in all of the last sightings; and the jaws have not
/// been opened since.
bool ThingFuture::is_in_hand(Thing& thing, const ThingSighting& sighting, const JointPositions& joints) const {
  const auto held = std::find_if(thing.spells.rbegin(), thing.spells.rend(),
                                 [](const Spell& spell) { return spell.kind == Kind::carried; });
  if (held == thing.spells.rend()) return false;
  const Pose T_grip_thing = world_->grip_frame(held->jaw, joints).inverse(Eigen::Isometry) * sighting.T_world_thing;
  if (!thing.seen.empty() && sighting.captured <= thing.seen.back().captured) return false;
  thing.seen.push_back({sighting.captured, sighting.T_world_thing, T_grip_thing, 0});
  while (to_seconds(sighting.captured - thing.seen.front().captured) > kWatched) thing.seen.pop_front();
  if (thing.spells.back().kind == Kind::carried) return false;
  if ((T_grip_thing.translation() - held->T.translation()).norm() > kAsBefore) return false;
  const std::string& joint = options_.jaws[held->jaw];
  const auto then = joints(joint), now = joints_now()(joint);
  if (!then || !now || opening_[held->jaw] * (*now - *then) > kJawsOpened) return false;
  const double same = std::max(kSameInHand, kSigmas * sighting.sigma);
  for (auto before = thing.seen.rbegin() + 1; before != thing.seen.rend(); ++before) {
    if ((before->T_grip_thing.translation() - T_grip_thing.translation()).norm() > same) return false;
    const double along = (before->T_world_thing.translation() - sighting.T_world_thing.translation()).norm();
    if (along > kAlong + same) return true;
  }
  return false;
}

void ThingFuture::take_back(Thing& thing, const ThingSighting& sighting) {
  const auto held = std::find_if(thing.spells.rbegin(), thing.spells.rend(),
                                 [](const Spell& spell) { return spell.kind == Kind::carried; });
  const std::size_t jaw = held->jaw;
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
