#include "apps/calibrate/target_command.hpp"

#include <nlohmann/json.hpp>

#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "apps/calibrate/outputs.hpp"
#include "calibration/target/find_corners.hpp"
#include "calibration/target/print_board.hpp"
#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

struct TargetArguments {
  std::string board, out, paper = "A4", measured;
  std::optional<std::filesystem::path> json;
};

std::pair<double, double> parse_measured(const std::string& text) {
  const std::size_t comma = text.find_first_of(", ");
  if (comma != std::string::npos) {
    const auto x = parse_number(text.substr(0, comma)), y = parse_number(text.substr(comma + 1));
    if (x && y) return {*x, *y};
  }
  throw InputError("--measured", in_quotes(text) + " is not two lengths", "give both rulers in mm, such as 100.2,99.9");
}

struct Printed {
  double x_mm, y_mm;  // of the rulers
  Board board;
};

Printed printed_board(const Board& board, const std::string& measured) {
  const auto [x, y] = parse_measured(measured);
  return {x, y, measured_board(board, x, y)};
}

/// Empty where nobody is there to answer, or does not know yet.
std::string ask() {
  if (isatty(STDIN_FILENO) == 0 || isatty(STDERR_FILENO) == 0) return {};
  std::fputs("Print it at 100 %, then measure the two rulers in mm and type X,Y (Enter: later, with --measured): ",
             stderr);
  std::string line;
  std::getline(std::cin, line);
  return line;
}

int run(const TargetArguments& a) {
  const Board board = parse_board(a.board);
  if (a.out.empty() && a.measured.empty())
    throw InputError("--out", "is missing", "name a .pdf file, or give --measured for a board that is printed");
  std::optional<Printed> printed;  // refused before a file is written
  if (!a.measured.empty()) printed = printed_board(board, a.measured);
  if (!a.out.empty()) {
    if (board.kind == BoardKind::apriltag) BoardFinder{board};  // enough tags in the family?
    write_board_pdf(a.out, board, parse_paper(a.paper));
    std::fprintf(stderr, "target: %s holds %s\n", a.out.c_str(), to_string(board).c_str());
    if (!printed)
      if (const std::string answer = ask(); !answer.empty()) printed = printed_board(board, answer);
  }
  nlohmann::ordered_json numbers{{"board", to_string(board)}};
  if (!printed) {
    std::fprintf(stderr,
                 "target: measure both rulers, then: foresight calibrate target --board %s --measured X_MM,Y_MM\n",
                 to_string(board).c_str());
  } else {
    std::fprintf(stderr, "target: printed at %.2f %% (x) and %.2f %% (y); use from now on:\n", printed->x_mm,
                 printed->y_mm);
    std::printf("--board %s\n", to_string(printed->board).c_str());
    numbers["measured_board"] = to_string(printed->board);
    numbers["scale_x"] = printed->x_mm / kRulerMm;
    numbers["scale_y"] = printed->y_mm / kRulerMm;
  }
  write_json(a.json, numbers);
  return 0;
}

}  // namespace

void add_target(Command& calibrate, std::function<int()>& action) {
  auto* command = calibrate.add_subcommand("target", "Print a board at true scale, and check the print");
  auto a = std::make_shared<TargetArguments>();
  command->add_option("--board", a->board, "chessboard|charuco|apriltag|circles:COLSxROWS:SIZE_M[:EXTRA[:FAMILY]]")
      ->required();
  command->add_option("--out", a->out, "PDF to write")->writes(board_form());
  command->add_option("--paper", a->paper, "A4 (default), A3 .. A0, letter, or WxH in mm");
  command->add_option("--measured", a->measured, "What the two printed rulers of 100 mm measure: X_MM,Y_MM");
  command->add_option("--json", a->json, "File for all numbers")->writes(numbers_form());
  command->footer(
      "Example: foresight calibrate target --board chessboard:9x6:0.025 --paper A3 --out board.pdf\n"
      "         foresight calibrate target --board chessboard:9x6:0.025 --measured 99.8,99.9");
  command->callback([a, &action] { action = [a] { return run(*a); }; });
}

}  // namespace foresight
