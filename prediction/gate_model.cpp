#include "prediction/gate_model.hpp"

#include <algorithm>
#include <utility>

namespace foresight {

GateModel::GateModel(GateOptions options, RobotShape* shape) : options_(std::move(options)), motion_(options_, shape) {}

void GateModel::set(const State& state) noexcept {
  state_ = state;
  for (std::size_t i = 0; i < options_.joints.size(); ++i) motion_.set(i, state.motion[i]);
}

void GateModel::set_released(bool released) noexcept {
  if (state_.released != released) state_.released_at = state_.time;
  state_.released = released;
}

void GateModel::stop(bool released) noexcept {
  state_.doing = GateDoing::stopping;
  set_released(released);
}

// The robot's end of a line will ask for another consent, which nobody knows yet.
void GateModel::lose() noexcept {
  if (state_.doing == GateDoing::following) stop(false);
  if (state_.consent.value_or(0) == 0) return;
  state_.consent = 0;
  state_.consent_at = state_.time;
  set_released(false);
}

void GateModel::take(const SentSetPoint& set_point, RobotTime now) noexcept {
  state_.taken = set_point.number;
  if (now > set_point.sent + set_point.lasts) {
    if (!set_point.deadman && state_.consent && state_.doing == GateDoing::following) lose();
    return;
  }
  for (std::size_t i = 0; i < options_.joints.size(); ++i) {
    if (options_.joints[i].reaches(set_point.position[i])) continue;
    // The one before came for the last time a cycle ago.
    if (state_.newest != SetPointKind::refused)
      state_.expires = std::min(state_.expires, state_.time + seconds(options_.command_age_s));
    state_.newest = SetPointKind::refused;
    return;
  }
  state_.newest = set_point.deadman ? SetPointKind::pressed : SetPointKind::open;
  state_.target = set_point.position;
  state_.expires = set_point.sent + set_point.lasts;
  state_.agreed = set_point.consent;
}

// A press that may not move the robot now does not later either.
void GateModel::press(RobotTime now) noexcept {
  const bool agrees = !state_.consent || (*state_.consent != 0 && *state_.consent == state_.agreed);
  if (state_.doing == GateDoing::following) {
    if (!agrees) lose();
  } else if (state_.doing == GateDoing::idle && state_.released && agrees) {
    state_.doing = GateDoing::following;
    state_.engaged = now;
  } else if (state_.consent) {
    set_released(false);
  }
}

void GateModel::heed_newest(RobotTime now) noexcept {
  if (now > state_.expires) {
    if (state_.newest != SetPointKind::none || state_.doing == GateDoing::following) lose();
    state_.newest = SetPointKind::none;  // one loss asks for one other consent
  } else if (state_.newest == SetPointKind::open) {
    if (state_.doing == GateDoing::following) stop(true);
    set_released(true);
  } else if (state_.newest == SetPointKind::pressed) {
    press(now);
  }
}

void GateModel::cycle(RobotTime now) noexcept {
  state_.time = now;
  state_.blocked = false;
  heed_newest(now);
  if (state_.doing == GateDoing::following)
    state_.blocked = motion_.go_towards(state_.target, options_.speed_after(now - state_.engaged)).has_value();
  else
    motion_.halt();
  if (state_.doing == GateDoing::stopping && motion_.at_rest()) state_.doing = GateDoing::idle;
  state_.motion = motion_.all();
}

}  // namespace foresight
