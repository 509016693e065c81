#include "calibration/robot/hand_eye_score.hpp"

#include <algorithm>
#include <cmath>

#include "calibration/robot/hand_eye_problem.hpp"
#include "calibration/robot/hand_eye_start.hpp"

namespace foresight {
namespace {

struct Sums {
  double px = 0, m = 0, across = 0;
  int points = 0;
};

BoardView kept_corners(const BoardView& view, const std::vector<bool>& keep) {
  BoardView out{view.name, {}};
  for (std::size_t c = 0; c < view.corners.size(); ++c)
    if (keep[c]) out.corners.push_back(view.corners[c]);
  return out;
}

Sums predict(const HandEyeData& data, const BoardView& view, std::size_t v, const HandEyeState& state) {
  Sums sums;
  const Vector6d step = joint_correction(state, data.poses[v]);
  const Pose T_robot =
      predicted_board(state.mount, moved(data.poses[v].T_base_flange, step), to_pose(state.X), to_pose(state.Y));
  std::vector<Eigen::Vector3d> p_board;
  for (const Eigen::Vector3d& p : data.corners.p_board) p_board.push_back(scaled_point(state, p));
  const Pose T_image = board_pose(state.camera, p_board, view).T_camera_board;
  for (const Corner& corner : view.corners) {
    const Eigen::Vector3d& p = data.corners.p_board[static_cast<std::size_t>(corner.index)];
    sums.px += (predicted_pixel(state, data.poses[v], step, p) - corner.pixel).squaredNorm();
    const Eigen::Vector3d& q = p_board[static_cast<std::size_t>(corner.index)];
    const Eigen::Vector3d seen = T_image * q, off = T_robot * q - seen;
    sums.m += off.squaredNorm();
    sums.across += off.squaredNorm() - std::pow(off.dot(seen.normalized()), 2);
    ++sums.points;
  }
  return sums;
}

// The corners of `view`, counted from the corner of the board that the robot has there.
BoardView turned_like_robot(const BoardView& view, const std::vector<BoardTurn>& turns, const HandEyeState& state,
                            const HandEyeData& data, const RobotPose& robot) {
  BoardView best = view;
  double least = INFINITY;
  for (const BoardTurn& turn : turns) {
    BoardView one = view;
    double sum = 0;
    for (Corner& corner : one.corners) {
      corner.index = turn.order[static_cast<std::size_t>(corner.index)];
      const Eigen::Vector3d& p = data.corners.p_board[static_cast<std::size_t>(corner.index)];
      sum += (predicted_pixel(state, robot, Vector6d::Zero(), p) - corner.pixel).squaredNorm();
    }
    if (sum < least) least = sum, best = std::move(one);
  }
  return best;
}

}  // namespace

HandEyeScore score_hand_eye(const KnownHandEye& known, const HandEyeData& data) {
  HandEyeState state;
  state.mount = known.mount, state.camera = known.camera, state.board_scale = known.board_scale;
  state.X = to_parameters(known.X), state.Y = to_parameters(known.Y);
  const std::vector<BoardTurn> turns = board_turns(data.corners.p_board, data.cols, data.rows);
  HandEyeScore score;
  Sums all;
  for (std::size_t v = 0; v < data.poses.size(); ++v) {
    const BoardView view = turned_like_robot(data.corners.views[v], turns, state, data, data.poses[v]);
    const Sums sums = predict(data, view, v, state);
    all.px += sums.px, all.m += sums.m, all.points += sums.points;
    ++score.views;
    if (const double px = std::sqrt(sums.px / std::max(1, sums.points)); px > score.worst_px)
      score.worst_px = px, score.worst = view.name;
  }
  score.px = std::sqrt(all.px / std::max(1, all.points));
  score.mm = 1e3 * std::sqrt(all.m / std::max(1, all.points));
  return score;
}

void score_left_out(const HandEyeData& data, const HandEyeSelection& selection, const HandEyeState& state,
                    HandEyeSummary& summary) {
  Sums all;
  for (std::size_t v = 0; v < data.poses.size(); ++v) {
    if (!selection.used[v]) continue;
    HandEyeSelection others = selection;
    others.used[v] = false;
    HandEyeState without = state;
    without.corrections[v] = {};
    adjust(data, others, 6, without);
    const Sums sums = predict(data, kept_corners(data.corners.views[v], selection.keep[v]), v, without);
    HandEyeView& view = summary.views[v];
    const double points = std::max(1, sums.points);
    view.loo_px = std::sqrt(sums.px / points);
    view.loo_mm = 1e3 * std::sqrt(sums.m / points);
    view.loo_across_mm = 1e3 * std::sqrt(sums.across / points);
    all.px += sums.px, all.m += sums.m, all.across += sums.across, all.points += sums.points;
  }
  const double points = std::max(1, all.points);
  summary.loo_px = std::sqrt(all.px / points);
  summary.loo_mm = 1e3 * std::sqrt(all.m / points);
  summary.loo_across_mm = 1e3 * std::sqrt(all.across / points);
}

}  // namespace foresight
