#include "calibration/target/board.hpp"

#include <array>
#include <sstream>

#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/split.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

struct Kind {
  BoardKind kind;
  const char* name;
  const char* example;
  std::size_t most_parts;  // of the form's parts between colons
  int fewest;              // of columns and rows
};
constexpr std::array<Kind, 4> kKinds{{
    {BoardKind::chessboard, "chessboard", "chessboard:9x6:0.025", 3, 2},
    {BoardKind::charuco, "charuco", "charuco:5x7:0.036:0.018:DICT_6X6_250", 5, 3},
    {BoardKind::apriltag, "apriltag", "apriltag:6x6:0.055:0.0165:tag36h11", 5, 1},
    {BoardKind::circles, "circles", "circles:10x10:0.0254", 3, 2},
}};
constexpr int kMostPoints = 1000;  // columns or rows
constexpr double kLargest = 1;     // metres: what is printed is smaller
constexpr double kKalibrGap = 0.3;

const Kind& kind_of(BoardKind kind) {
  for (const Kind& k : kKinds)
    if (k.kind == kind) return k;
  return kKinds.front();
}

class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text), parts_(split(text, ':')) {}

  Board parse() {
    const Kind& kind = find_kind();
    example_ = kind.example;
    if (parts_.size() < 3 || parts_.size() > kind.most_parts)
      refuse("has " + counted(parts_.size(), "part") + " between colons");
    Board board;
    board.kind = kind.kind;
    const auto counts = split(parts_[1], 'x');
    if (counts.size() != 2) refuse("has no COLSxROWS in " + in_quotes(parts_[1]));
    board.cols = count(counts[0], kind.fewest);
    board.rows = count(counts[1], kind.fewest);
    board.size_m = metres(parts_[2]);
    const double extra = parts_.size() > 3 ? metres(parts_[3]) : 0;
    if (parts_.size() > 4) board.family = parts_[4];
    if (board.kind == BoardKind::charuco) board.marker_m = extra;
    if (board.kind == BoardKind::charuco && extra >= board.size_m) refuse("has markers that do not fit into a square");
    if (board.kind == BoardKind::apriltag) {
      board.gap_m = parts_.size() > 3 ? extra : kKalibrGap * board.size_m;
      if (board.family.empty()) board.family = "tag36h11";
    }
    return board;
  }

 private:
  const Kind& find_kind() {
    std::vector<std::string> names;
    for (const Kind& k : kKinds) {
      if (parts_[0] == k.name) return k;
      names.emplace_back(k.name);
    }
    const std::string word = lower(parts_[0]);
    const std::string nearest = nearest_word(word.starts_with("check") ? "chessboard" : word, names);
    for (const Kind& k : kKinds)
      if (nearest == k.name) example_ = k.example;
    refuse("is of no known kind " + in_quotes(parts_[0]) + "; kinds are " + joined(names));
  }

  int count(const std::string& text, int fewest) {
    const auto value = parse_integer(text);
    if (value && *value > kMostPoints)
      refuse("has " + in_quotes(text) + " columns or rows, and more than " + std::to_string(kMostPoints) +
             " cannot be told apart in an image");
    if (!value || *value < fewest)
      refuse("has " + in_quotes(text) + " where a count of at least " + std::to_string(fewest) + " belongs");
    return static_cast<int>(*value);
  }

  double metres(const std::string& text) {
    const auto value = parse_number(text);
    if (value && *value > kLargest && *value <= 1e3 * kLargest)
      refuse("has a size of " + text + " m, which looks like millimetres: " + readable(1e-3 * *value, 5));
    if (!value || !(*value > 0) || !(*value <= kLargest))
      refuse("has " + in_quotes(text) + " where a size in metres belongs");
    return *value;
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError("--board", "the board " + in_quotes(text_) + " " + what,
                     "give KIND:COLSxROWS:SIZE_M, such as " + example_);
  }

  std::string_view text_;
  std::vector<std::string> parts_;
  std::string example_ = kKinds.front().example;
};

std::vector<Eigen::Vector3d> grid(int cols, int rows, double pitch) {
  std::vector<Eigen::Vector3d> points;
  for (int row = 0; row < rows; ++row)
    for (int col = 0; col < cols; ++col) points.emplace_back(col * pitch, row * pitch, 0);
  return points;
}

std::vector<Eigen::Vector3d> tag_corners(const Board& board) {
  const double s = board.size_m, pitch = s + board.gap_m;
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3d& at : grid(board.cols, board.rows, pitch))
    for (const auto& [x, y] : {std::pair{0.0, s}, {s, s}, {s, 0.0}, {0.0, 0.0}})
      points.emplace_back(at.x() + x, at.y() + y, 0);
  return points;
}

}  // namespace

Board parse_board(std::string_view text) {
  return Parser(text).parse();
}

std::string to_string(const Board& board) {
  std::ostringstream out;
  out.precision(12);
  out << kind_of(board.kind).name << ':' << board.cols << 'x' << board.rows << ':' << board.size_m;
  const double extra = board.kind == BoardKind::apriltag ? board.gap_m : board.marker_m;
  if (extra > 0) out << ':' << extra;
  if (extra > 0 && !board.family.empty()) out << ':' << board.family;
  return out.str();
}

std::vector<Eigen::Vector3d> board_points(const Board& board) {
  switch (board.kind) {
    case BoardKind::apriltag: return tag_corners(board);
    case BoardKind::charuco: return grid(board.cols - 1, board.rows - 1, board.size_m);
    default: return grid(board.cols, board.rows, board.size_m);
  }
}

}  // namespace foresight
