#include "calibration/camera/pair_checks.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "calibration/camera/board_pose.hpp"
#include "calibration/camera/rig_start.hpp"
#include "common/error.hpp"
#include "common/statistics.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr double kWorst = 1e4;           // px: an error that says no more than that it is wrong
constexpr std::size_t kCandidates = 30;  // places of the right camera that are tried

// Above 0 where the board's x and y run like the image's right and down.
double orientation(const std::vector<Eigen::Vector3d>& p_board, const std::vector<Corner>& corners) {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> b = Eigen::Matrix<double, 3, 2>::Zero();
  for (const Corner& corner : corners) {
    const Eigen::Vector3d at = p_board[static_cast<std::size_t>(corner.index)].head<2>().homogeneous();
    A += at * at.transpose();
    b += at * corner.pixel.transpose();
  }
  const Eigen::Matrix<double, 3, 2> affine = A.fullPivLu().solve(b);
  return affine.topRows<2>().determinant();
}

// Where point i lies when the board is turned by 180 degrees; empty for a board without that symmetry.
std::vector<int> mirrored_indices(const std::vector<Eigen::Vector3d>& p_board, bool x, bool y) {
  Eigen::Vector3d low = p_board.front(), high = p_board.front();
  for (const Eigen::Vector3d& p : p_board) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const double tolerance = 1e-6 * (high - low).norm();
  std::vector<int> indices;
  for (const Eigen::Vector3d& p : p_board) {
    const Eigen::Vector3d at(x ? low.x() + high.x() - p.x() : p.x(), y ? low.y() + high.y() - p.y() : p.y(), p.z());
    const auto found = std::find_if(p_board.begin(), p_board.end(),
                                    [&](const Eigen::Vector3d& q) { return (q - at).norm() < tolerance; });
    if (found == p_board.end()) return {};
    indices.push_back(static_cast<int>(found - p_board.begin()));
  }
  return indices;
}

void relabel(std::vector<Corner>& corners, const std::vector<int>& indices) {
  for (Corner& corner : corners) corner.index = indices[static_cast<std::size_t>(corner.index)];
  std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) { return a.index < b.index; });
}

struct Pair {
  std::size_t view = 0;  // of the left camera
  Pose T_left_board;
  Pose T_right_board;
  Pose T_right_turned;  // the board turned by 180 degrees in itself
};

class Consensus {
 public:
  Consensus(const RigViews& views, const CameraModel& right, std::vector<Pair> pairs)
      : right_(right), pairs_(std::move(pairs)) {
    Eigen::Vector3d low = views.p_board.front(), high = low;
    for (const Eigen::Vector3d& p : views.p_board) low = low.cwiseMin(p), high = high.cwiseMax(p);
    corners_ = {low, {high.x(), low.y(), 0}, high, {low.x(), high.y(), 0}};
    turnable_ = !mirrored_indices(views.p_board, true, true).empty();
    find();
  }

  const std::vector<Pair>& pairs() const { return pairs_; }
  const std::vector<double>& errors() const { return errors_; }         // px, of each pair as it is
  const std::vector<double>& turned_errors() const { return turned_; }  // with the board turned
  double median_px() const { return median_; }

 private:
  void find() {
    median_ = std::numeric_limits<double>::infinity();
    const std::size_t step = std::max<std::size_t>(1, pairs_.size() / kCandidates);
    for (std::size_t i = 0; i < pairs_.size(); i += step)
      for (const bool turned : {false, true}) {
        if (turned && !turnable_) continue;
        const Pair& p = pairs_[i];
        test(p.T_left_board * (turned ? p.T_right_turned : p.T_right_board).inverse());
      }
  }

  void test(const Pose& T_left_right) {
    std::vector<double> as_is, turned, smaller;
    for (const Pair& p : pairs_) {
      const Pose predicted = T_left_right.inverse() * p.T_left_board;
      as_is.push_back(error(predicted, p.T_right_board));
      turned.push_back(turnable_ ? error(predicted, p.T_right_turned) : kWorst);
      smaller.push_back(std::min(as_is.back(), turned.back()));
    }
    const double middle = median(std::move(smaller));
    if (middle >= median_) return;
    median_ = middle;
    errors_ = std::move(as_is);
    turned_ = std::move(turned);
  }

  double error(const Pose& a, const Pose& b) const {
    double sum = 0;
    for (const Eigen::Vector3d& p : corners_) {
      const auto pa = project(right_, a * p), pb = project(right_, b * p);
      sum += pa && pb ? std::min(kWorst, (*pa - *pb).norm()) : kWorst;
    }
    return sum / static_cast<double>(corners_.size());
  }

  const CameraModel& right_;
  std::vector<Pair> pairs_;
  std::array<Eigen::Vector3d, 4> corners_;
  bool turnable_ = false;
  std::vector<double> errors_, turned_;
  double median_ = 0;
};

std::vector<const Pose*> poses_by_view(const RigViews& views, int camera, const RigSolution& solution) {
  std::vector<const Pose*> poses(views.views.size());
  const auto indices = views_of(views, camera).indices;
  for (std::size_t i = 0; i < indices.size(); ++i) poses[indices[i]] = &solution.T_left_board[i];
  return poses;
}

// Left views with the right view that lies `shift` pairs later.
std::vector<Pair> pairs_of(const RigViews& views, const RigSolution& left, const RigSolution& right, int shift) {
  const auto L = poses_by_view(views, 0, left), R = poses_by_view(views, 1, right);
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : views.p_board) box.extend(p);
  Pose half_turn = Pose::Identity();  // about the middle of the board
  half_turn.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  half_turn.translation() = box.center() - half_turn.linear() * box.center();
  std::vector<std::size_t> both;
  for (std::size_t v = 0; v < views.views.size(); ++v)
    if (L[v] && R[v]) both.push_back(v);
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < both.size(); ++i) {
    const auto other = static_cast<std::ptrdiff_t>(i) + shift;
    if (other < 0 || other >= static_cast<std::ptrdiff_t>(both.size())) continue;
    const Pose& T_right_board = *R[both[static_cast<std::size_t>(other)]];
    pairs.push_back({both[i], *L[both[i]], T_right_board, T_right_board * half_turn});
  }
  return pairs;
}

bool mirrored_explains(const RigViews& views, const RigSolution& left, const RigSolution& right, double limit) {
  RigViews turned = views;
  const auto columns = mirrored_indices(views.p_board, true, false);
  if (columns.empty()) return false;
  for (RigView& view : turned.views) {
    for (Corner& corner : view.corners[1]) corner.pixel.x() = turned.width[1] - 1 - corner.pixel.x();
    relabel(view.corners[1], columns);
  }
  const CameraViews alone = views_of(turned, 1);
  RigSolverOptions options;
  options.warp = false;
  try {
    const auto solved = solve_rig(alone.views, start_camera(alone.views, right.rig.cameras[0].distortion), options);
    return Consensus(turned, solved.rig.cameras[0], pairs_of(turned, left, solved, 0)).median_px() < limit;
  } catch (const InputError&) {
    return false;
  }
}

[[noreturn]] void refuse_pairs(const RigViews& views, const RigSolution& left, const RigSolution& right, double found) {
  const std::string from = "from " + readable(found, 1) + " to ";
  for (const int shift : {1, -1}) {
    auto pairs = pairs_of(views, left, right, shift);
    if (pairs.size() < 3) continue;
    const double shifted = Consensus(views, right.rig.cameras[0], std::move(pairs)).median_px();
    if (shifted > found / 3) continue;
    const std::string first = shift > 0 ? "right" : "left", last = shift > 0 ? "left" : "right";
    throw InputError("pairs",
                     "they are shifted by one: with the next " + first + " view for each " + last +
                         " one the error between the cameras falls " + from + readable(shifted, 1, " px"),
                     "drop the first " + first + " image and the last " + last + " one, and name the pairs anew");
  }
  if (mirrored_explains(views, left, right, found / 3))
    throw InputError("pairs", "one of the two cameras delivers mirrored images", "turn its mirroring off");
  throw InputError(
      "pairs",
      "no one place of the right camera explains even half of them: the middle error is " + readable(found, 1, " px"),
      "check that equal names were taken at the same instant, and that the cameras did not move "
      "against each other");
}

}  // namespace

void check_orientation(RigViews& views, ViewRepairs& repairs) {
  std::array<int, 2> plain{}, mirrored{};
  std::vector<std::array<double, 2>> signs(views.views.size());
  for (std::size_t v = 0; v < views.views.size(); ++v)
    for (std::size_t c = 0; c < 2; ++c) {
      if (views.views[v].corners[c].empty()) continue;
      signs[v][c] = orientation(views.p_board, views.views[v].corners[c]);
      ++(signs[v][c] > 0 ? plain : mirrored)[c];
    }
  if (views.cameras == 2) {
    const auto mostly = [](int some, int others) { return some > 2 * others; };
    for (std::size_t c = 0; c < 2; ++c)
      if (mostly(mirrored[c], plain[c]) && mostly(plain[1 - c], mirrored[1 - c]))
        throw InputError("the " + camera_name(static_cast<int>(c), 2) + " camera",
                         "it sees the board mirrored, the other one does not", "turn its mirroring off");
  }
  const double most = plain[0] + plain[1] >= mirrored[0] + mirrored[1] ? 1 : -1;
  std::vector<std::size_t> kept;
  for (std::size_t v = 0; v < views.views.size(); ++v) {
    if (most * signs[v][0] < 0 || most * signs[v][1] < 0)
      repairs.dropped.push_back(views.views[v].name + ": its board is mirrored");
    else
      kept.push_back(v);
  }
  if (kept.size() < views.views.size()) views = subset(views, kept);
}

void check_pairs(RigViews& views, const RigSolution& left, const RigSolution& right, ViewRepairs& repairs) {
  constexpr double kFewPixels = 5;  // more than two cameras solved alone disagree, far less than a wrong pair does
  constexpr double kTimesMedian = 10;
  const Consensus consensus(views, right.rig.cameras[0], pairs_of(views, left, right, 0));
  const double median = consensus.median_px();
  if (consensus.pairs().size() > 2 && median > 3 * kFewPixels) refuse_pairs(views, left, right, median);
  const double limit = std::max(kFewPixels, kTimesMedian * median);
  const auto turned = mirrored_indices(views.p_board, true, true);
  std::vector<char> drop(views.views.size(), 0);
  for (std::size_t i = 0; i < consensus.pairs().size(); ++i) {
    RigView& view = views.views[consensus.pairs()[i].view];
    if (consensus.errors()[i] <= limit && consensus.errors()[i] <= consensus.turned_errors()[i]) continue;
    if (consensus.turned_errors()[i] <= limit) {
      relabel(view.corners[1], turned);
      repairs.turned.push_back(view.name);
    } else {
      drop[consensus.pairs()[i].view] = 1;
      repairs.dropped.push_back(view.name + ": its two images are " + readable(consensus.errors()[i], 0, " px") +
                                " from belonging together");
    }
  }
  std::vector<std::size_t> kept;
  for (std::size_t v = 0; v < views.views.size(); ++v)
    if (!drop[v]) kept.push_back(v);
  if (kept.size() < views.views.size()) views = subset(views, kept);
}

}  // namespace foresight
