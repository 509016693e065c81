#include "apps/calibrate/mock_board.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "calibration/target/board_drawing.hpp"
#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr sim::PanTilt kHead{0.15, -0.2};
constexpr double kRoom = 1.2;                      // metres from the cameras to what stands before the wall
constexpr double kRim = 6;                         // px around the board
constexpr double kStandsFor = 0.7, kBefore = 0.1;  // seconds; so long before its instant it stands already
constexpr int kColumns = 4, kRows = 3;             // of the image's parts
constexpr double kShares[] = {0.45, 0.6, 0.36};    // of the image's width that the board takes
// Nearer, the two images would differ by more than this share of their width, and the outer parts of one stay empty.
constexpr double kMostDisparity = 0.15;

double evenly(std::mt19937& random, double from, double to) {
  return from + (to - from) * (static_cast<double>(random()) / 4294967296.0);
}

/// What both cameras must see: the outer points with one size of ink and paper around them.
struct Outline {
  std::vector<Eigen::Vector3d> p_board;
  Eigen::Vector3d middle;
  double width = 0;
};

Outline outline_of(const Board& board) {
  const BoardExtent e = board_extent(board);
  Outline out;
  for (const double x : {e.left, (e.left + e.right) / 2, e.right})
    for (const double y : {e.top, (e.top + e.bottom) / 2, e.bottom}) out.p_board.emplace_back(x, y, 0);
  out.middle = {(e.left + e.right) / 2, (e.top + e.bottom) / 2, 0};
  out.width = std::max(e.width(), e.height());
  return out;
}

struct Station {
  Eigen::Vector2d aim;  // 0 .. 1 of the left image
  double share = 0.5;   // of the image's width that the board's longer side takes
  double tilt = 0, turn = 0, roll = 0;
};

/// Puts the board as near to the station's aim as both cameras allow.
class Placing {
 public:
  Placing(const Outline& outline, const StereoLenses& cameras) : outline_(outline), cameras_(cameras) {
    const Lens::Parameters& p = cameras_.left.parameters();
    const double nearest = p.fx * cameras_.T_left_right.translation().norm() / (kMostDisparity * p.width);
    farther_ = std::max(1.0, nearest / distance(*std::max_element(std::begin(kShares), std::end(kShares))));
  }

  Pose operator()(const Station& station) const {
    const Lens::Parameters& p = cameras_.left.parameters();
    const Eigen::Vector2d middle(p.width / 2.0, p.height / 2.0);
    const Eigen::Vector2d aim(station.aim.x() * p.width, station.aim.y() * p.height);
    for (double z = farther_ * distance(station.share); z < kRoom; z *= 1.08)
      for (int step = 0; step <= kSteps; ++step) {
        const Pose T = at(aim + step / double(kSteps) * (middle - aim), z, station);
        if (seen(T)) return T;
      }
    throw InputError("--board",
                     "both mock cameras see it whole only from more than " + readable(kRoom, 1) +
                         " m, and the lab has no room for that",
                     "take a smaller --board, or one with its sides more alike");
  }

 private:
  static constexpr int kSteps = 24;

  double distance(double share) const {
    return cameras_.left.parameters().fx * outline_.width / (share * cameras_.left.width());
  }

  Pose at(const Eigen::Vector2d& pixel, double z, const Station& s) const {
    const auto ray = cameras_.left.unproject({pixel.x(), pixel.y()});
    Pose T = Pose::Identity();
    if (!ray) return T;
    T.translate(*ray * (z / ray->norm()));
    T.rotate(Eigen::AngleAxisd(s.tilt, Eigen::Vector3d(std::cos(s.turn), std::sin(s.turn), 0)));
    T.rotate(Eigen::AngleAxisd(s.roll, Eigen::Vector3d::UnitZ()));
    T.translate(-outline_.middle);
    return T;
  }

  bool seen(const Pose& T_left_board) const {
    const Pose T_right_board = cameras_.T_left_right.inverse() * T_left_board;
    return std::all_of(outline_.p_board.begin(), outline_.p_board.end(), [&](const Eigen::Vector3d& p) {
      return inside(cameras_.left, T_left_board * p) && inside(cameras_.right, T_right_board * p);
    });
  }

  static bool inside(const Lens& lens, const Eigen::Vector3d& p) {
    if (p.z() <= 0.02) return false;
    const auto pixel = lens.project(p);
    return pixel && pixel->x() > kRim && pixel->y() > kRim && pixel->x() < lens.width() - 1 - kRim &&
           pixel->y() < lens.height() - 1 - kRim;
  }

  const Outline& outline_;
  const StereoLenses& cameras_;
  double farther_ = 1;
};

std::vector<Station> plan(unsigned seed) {
  constexpr double kDeg = std::numbers::pi / 180;
  constexpr double kTilts[] = {25, 40, 15, 33, 45};
  std::mt19937 random(seed);
  std::vector<int> parts;
  std::vector<Station> out;
  for (int k = 0; k < MockBoard::kStations; ++k) {
    if (parts.empty()) {
      for (int i = 0; i < kColumns * kRows; ++i) parts.push_back(i);
      for (std::size_t i = parts.size() - 1; i > 0; --i) std::swap(parts[i], parts[random() % (i + 1)]);
    }
    const int part = parts.back();
    parts.pop_back();
    Station s;
    // From border to border, so that the outer parts' boards touch it.
    s.aim = {part % kColumns / (kColumns - 1.0), part / kColumns / (kRows - 1.0)};
    s.share = kShares[k % 3] * evenly(random, 0.93, 1.07);
    s.tilt = (kTilts[k % 5] + evenly(random, -5, 0)) * kDeg;
    s.turn = (90 * (k % 4) + evenly(random, -30, 30)) * kDeg;
    s.roll = evenly(random, -14, 14) * kDeg;
    out.push_back(s);
  }
  return out;
}

Pose between(const Pose& a, const Pose& b, double share) {
  const double s = share * share * (3 - 2 * share);
  Pose out = Pose::Identity();
  out.translation() = (1 - s) * a.translation() + s * b.translation();
  out.linear() = Eigen::Quaterniond(a.linear()).slerp(s, Eigen::Quaterniond(b.linear())).toRotationMatrix();
  return out;
}

}  // namespace

MockBoard::MockBoard(const Board& board, const StereoLenses& cameras, unsigned seed) {
  const BoardPicture picture = board_picture(board);
  T_board_print_.translation() =
      Eigen::Vector3d(picture.width_m / 2 - picture.origin_m.x(), picture.height_m / 2 - picture.origin_m.y(), 0);
  print_ = {to_string(board), picture.picture, picture.width_m, picture.height_m};
  const Outline outline = outline_of(board);
  const Placing placing(outline, cameras);
  for (const Station& station : plan(seed)) T_left_board_.push_back(placing(station));
}

sim::MovingPrint MockBoard::print() const {
  return {print_, [copy = *this](double t) -> Pose { return copy.T_world_board(t) * copy.T_board_print_; }, {}};
}

Pose MockBoard::T_world_board(double t) const {
  const double since = std::max(0.0, t) / kStation + kBefore;
  const auto station = static_cast<std::size_t>(since);
  const double moved = (since - static_cast<double>(station) - kStandsFor) / (1 - kStandsFor);
  const Pose& a = T_left_board_[station % kStations];
  const Pose& b = T_left_board_[(station + 1) % kStations];
  return sim::T_world_head_left(kHead) * (moved > 0 ? between(a, b, moved) : a);
}

std::optional<double> MockBoard::shafts(std::string_view joint) {
  if (joint == "pan") return kHead.pan;
  if (joint == "tilt") return kHead.tilt;
  return sim::shafts_at_rest(joint);
}

std::unique_ptr<CaptureSource> mock_board_source(const StereoConfig& config, const Board& board, unsigned seed,
                                                 Clock& clock) {
  auto* const stepped = dynamic_cast<SteppedClock*>(&clock);
  MockWorld world;
  world.board = MockBoard(board, mock_options(config).lenses, seed).print();
  const auto shafts = [](std::string_view joint, RobotTime) { return MockBoard::shafts(joint); };
  OpenStereo opened = open_stereo(config, shafts, clock, world);
  return stepped ? stepped_source(std::move(opened), *stepped) : pair_source(std::move(opened));
}

}  // namespace foresight
