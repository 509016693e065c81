// May the key beside those that drive end the seat?
#pragma once

#include <vector>

#include "seat/seat_words.hpp"

namespace foresight {

/// It does not while the switch is held, and says why it did nothing: a robot that was let go of comes to rest by
/// itself. One thread.
class SeatEnding {
 public:
  void see(const SeatStatus& status);  ///< at each picture
  /// The key was pressed. True: the seat ends.
  bool press(const SeatStatus& status);
  /// For the head-up display: why the last press did nothing, as long as one would.
  std::vector<SeatLine> lines() const;

 private:
  bool refused_ = false;
};

}  // namespace foresight
