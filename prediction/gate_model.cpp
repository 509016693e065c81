#include "prediction/gate_model.hpp"

#include <algorithm>
#include <utility>

namespace foresight {

GateModel::GateModel(GateOptions options, RobotShape* shape) : options_(std::move(options)), motion_(options_, shape) {}

void GateModel::set(const State& state) noexcept {
  state_ = state;
  for (std::size_t i = 0; i < options_.joints.size(); ++i) motion_.set(i, state.motion[i]);
}

void GateModel::stop(bool released) noexcept {
  state_.doing = GateDoing::stopping;
  state_.released = released;
}

void GateModel::take(const SentSetPoint& set_point, RobotTime now) noexcept {
  state_.taken = set_point.number;
  if (now > set_point.sent + set_point.lasts) return;
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
}

void GateModel::heed_newest(RobotTime now) noexcept {
  if (now > state_.expires) {
    if (state_.doing == GateDoing::following) stop(false);
  } else if (state_.newest == SetPointKind::open) {
    if (state_.doing == GateDoing::following) stop(true);
    state_.released = true;
  } else if (state_.newest == SetPointKind::pressed && state_.doing == GateDoing::idle && state_.released) {
    state_.doing = GateDoing::following;
    state_.engaged = now;
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
