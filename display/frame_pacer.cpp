#include "display/frame_pacer.hpp"

#include <algorithm>

#include "gl/objects.hpp"

namespace foresight {

FramePacer::FramePacer(Clock& clock, const FramePacingOptions& options, std::shared_ptr<FrameGate> gate)
    : clock_(clock), pacing_(options, clock.now()), gate_(std::move(gate)) {}

bool FramePacer::wait(Duration most) {
  clock_.sleep_until(std::min(pacing_.wake(), clock_.now() + most));
  if (clock_.now() < pacing_.wake()) return false;
  if (gate_) gate_->frame_begins();
  return true;
}

void FramePacer::drawn() {
  glFinish();
  pacing_.drawn(clock_.now());
}

void FramePacer::swapped() {
  pacing_.swapped(clock_.now(), gate_ ? gate_->rest_due() : Duration{0});
  if (gate_) gate_->frame_ends(pacing_.wake());
}

void FramePacer::held_up() {
  pacing_.held_up(clock_.now());
  if (gate_) gate_->frame_ends(pacing_.wake());
}

}  // namespace foresight
