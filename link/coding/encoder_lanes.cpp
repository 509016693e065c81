#include "link/coding/encoder_lanes.hpp"

namespace foresight {

EncoderLanes::Place EncoderLanes::place(const PairWish& wish) const {
  const Lane *newest = nullptr, *unused = nullptr, *on_the_way = nullptr;
  const auto begins = [this](const Lane& lane) { return lane.broken || lane_rests(lane.captured, newest_); };
  for (const Lane& lane : lanes_) {
    if (begins(lane)) {
      if (!unused) unused = &lane;
      continue;
    }
    if (!on_the_way || lane.number > on_the_way->number) on_the_way = &lane;
    if ((lane.arrived || !wish.only_what_arrived) && (!newest || lane.number > newest->number)) newest = &lane;
  }
  const Lane& chosen = newest ? *newest : unused ? *unused : *on_the_way;
  return {static_cast<std::size_t>(&chosen - lanes_.data()), begins(chosen) ? 0 : chosen.number};
}

void EncoderLanes::coded(std::size_t lane, std::uint32_t number, RobotTime captured) {
  lanes_[lane] = {.number = number, .captured = captured, .arrived = false, .broken = false};
  newest_ = captured;
}

void EncoderLanes::arrived(std::uint32_t number) {
  for (Lane& lane : lanes_)
    if (lane.number == number) lane.arrived = true;
}

void EncoderLanes::gone(std::uint32_t number) {
  // Later pairs of the lane build on it: whichever lane has it, its newest pair is not before it. Those of other lanes
  // are told by their own numbers.
  for (Lane& lane : lanes_)
    if (lane.number == number) lane.broken = true;
}

void EncoderLanes::begin_anew() {
  for (Lane& lane : lanes_) lane.broken = true;
}

}  // namespace foresight
