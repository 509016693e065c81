#include "seat/seat_ending.hpp"

namespace foresight {

void SeatEnding::see(const SeatStatus& status, HandPhase phase) {
  held_ = status.held || phase != HandPhase::released;
  follows_ = status.control.follows;
  refused_ = refused_ && (held_ || follows_);
}

bool SeatEnding::press(const SeatStatus& status, HandPhase phase) {
  see(status, phase);
  refused_ = held_ || follows_;
  return !refused_;
}

std::vector<SeatLine> SeatEnding::lines() const {
  if (!refused_) return {};
  if (held_) return {{"end", "not while the switch is held", "let go of the switch to end", Urgency::note}};
  return {{"end", "not while the robot follows you", "wait until it is at rest", Urgency::note}};
}

}  // namespace foresight
