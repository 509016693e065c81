// What an operator is to know, in words: for the head-up display, logs and tests.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "seat/seat.hpp"

namespace foresight {

enum class Urgency : std::uint8_t { fine, note, trouble };

/// A line of the head-up display. Nothing is told by colour alone: `mark()` goes before it.
struct SeatLine {
  std::string label;  ///< "line", "robot"
  std::string words;
  std::string cure;  ///< what to do; "" where nothing is to be done
  Urgency urgency = Urgency::fine;
};
const char* mark(Urgency urgency);

/// In the order of what matters most. `names`: of the joints; `fault`: why no pictures come, or "".
std::vector<SeatLine> seat_lines(const SeatStatus& status, std::span<const std::string> names,
                                 const std::string& fault);

/// Without what is well, but who is in command: for who wants to see the picture.
void leave_out_fine(std::vector<SeatLine>& lines);

/// One sentence: may the operator drive, and if not, what is to be done first.
SeatLine next_step(const SeatStatus& status);

}  // namespace foresight
