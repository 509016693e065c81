// Boards on paper, at true scale, and what the printer made of it.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "calibration/target/board.hpp"

namespace foresight {

struct Paper {
  std::string name;
  double width_mm = 0;
  double height_mm = 0;  ///< upright; a board that fits better lying is printed lying
};

/// "A4", "A3", ... "A0", "letter", or "WxH" in mm. Throws InputError.
Paper parse_paper(std::string_view text);

inline constexpr double kRulerMm = 100;

/// One page of PDF: the board, its --board text, and a ruler of kRulerMm along each axis (shorter
/// sides of paper than that: as many tens of mm as fit). A ChArUco board needs marker size and
/// dictionary. Throws InputError where the board is larger than the paper, naming the largest that
/// fits, and RuntimeFailure where the file cannot be written.
void write_board_pdf(const std::filesystem::path& file, const Board& board, const Paper& paper);

/// The board as it came out: all sizes times the measured scale. `x_mm`, `y_mm`: what the two rulers
/// measure. Throws InputError where they cannot be rulers of kRulerMm, and where the axes differ by
/// more than kMostAnisotropy, for then the squares are rectangles.
Board measured_board(const Board& board, double x_mm, double y_mm);
inline constexpr double kMostAnisotropy = 0.005;

}  // namespace foresight
