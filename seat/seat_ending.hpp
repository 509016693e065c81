// May the key beside those that drive end the seat?
#pragma once

#include <vector>

#include "input/hand_control.hpp"
#include "seat/seat_words.hpp"

namespace foresight {

/// It ends only a seat that drives nothing; pressed while it drives, it is told why it did nothing. One thread.
class SeatEnding {
 public:
  /// At each picture. `phase`: of the hand (HandSight).
  void see(const SeatStatus& status, HandPhase phase);
  /// The key was pressed; likewise. True: the seat ends.
  bool press(const SeatStatus& status, HandPhase phase);
  /// For the head-up display: why the last press did nothing, as long as one would.
  std::vector<SeatLine> lines() const;

 private:
  bool held_ = false, follows_ = false, refused_ = false;
};

}  // namespace foresight
