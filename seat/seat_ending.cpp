#include "seat/seat_ending.hpp"

namespace foresight {

void SeatEnding::see(const SeatStatus& status) {
  refused_ = refused_ && status.held;
}

bool SeatEnding::press(const SeatStatus& status) {
  refused_ = status.held;
  return !refused_;
}

std::vector<SeatLine> SeatEnding::lines() const {
  if (!refused_) return {};
  return {{"end", "not while the switch is held", "let go of the switch to end", Urgency::note}};
}

}  // namespace foresight
