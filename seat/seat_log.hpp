// What changes at a seat, once each, for a log: what the head-up display tells at each moment.
#pragma once

#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "seat/seat_words.hpp"

namespace foresight {

/// One thread. Figures that change are no news; what is said besides them is, and that it is no longer so.
class SeatLog {
 public:
  /// What is new since the last call, in the order of `lines`, such as "robot: emergency stop; reset (X)".
  std::vector<std::string> news(std::span<const SeatLine> lines);

 private:
  struct Told {
    std::string words, text;  // words: without figures, with the cure
    Urgency urgency = Urgency::fine;
    bool now = false;  // it is among the lines of this call
  };
  std::map<std::pair<std::string, int>, Told> told_;  // by label, of which a call may have several lines
};

}  // namespace foresight
