#include "calibration/robot/hand_eye.hpp"

#include <algorithm>

#include "calibration/robot/hand_eye_problem.hpp"
#include "calibration/robot/hand_eye_score.hpp"
#include "calibration/robot/hand_eye_start.hpp"
#include "calibration/robot/hand_eye_verdict.hpp"
#include "calibration/robot/motion_check.hpp"
#include "calibration/robot/pose_reading.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr std::size_t kFewestViews = 5, kFewViews = 10;
constexpr double kSizeDoubted = 3;  // times the doubt about the board's size before the images
constexpr double kClearly = 0.7;    // of two mounts or orders of corners, the better one's misfit over the other's
constexpr double kContradicts = 8;  // a robot pose this many times the median correction off is wrong
constexpr double kWildPose = 22.5;  // squared, of six coordinates: a normal one in a thousand lies beyond
constexpr double kHardlyTrusted = 0.4;
constexpr double kWildFreedom = 8;  // of Student's t: the mildest tail that helped on recorded wild poses

void require_views(const HandEyeData& data) {
  const std::size_t views = data.corners.views.size();
  if (data.poses.size() != views)
    throw InputError("--poses", counted(data.poses.size(), "robot pose") + " for " + counted(views, "view"),
                     "give one pose for each view");
  if (views < kFewestViews)
    throw InputError("--images", "the board was found in " + counted(views, "view") + " only",
                     "take at least 5, better 15 or more");
  std::vector<Pose> poses;
  for (const RobotPose& pose : data.poses) poses.push_back(pose.T_base_flange);
  require_two_axes(motion_spread(poses), "--poses", "wrist");
}

void require_enough(const HandEyeData& data, const HandEyeSelection& selection) {
  const auto used = static_cast<std::size_t>(std::count(selection.used.begin(), selection.used.end(), true));
  if (used >= kFewestViews) return;
  std::string names;
  for (std::size_t v = 0; v < selection.used.size(); ++v)
    if (!selection.used[v]) names += (names.empty() ? "" : ", ") + data.corners.views[v].name;
  throw InputError("--poses",
                   "only " + std::to_string(used) + " robot poses agree with each other, not those of " + names,
                   "check that each pose belongs to its image, and take more views");
}

HandEyeStart best_start(const HandEyeOptions& options, const HandEyeData& data, std::span<const Pose> seen,
                        std::span<const Pose> symmetries, HandEyeSummary& summary) {
  std::vector<HandEyeStart> starts;
  for (const CameraMount mount : {CameraMount::fixed, CameraMount::moving}) {
    if (options.mount.value_or(mount) != mount) continue;
    starts.push_back(start_hand_eye(mount, data.poses, seen, symmetries));
    (mount == CameraMount::fixed ? summary.start_mm_fixed : summary.start_mm_moving) = 1e3 * starts.back().misfit_m;
  }
  if (starts.size() == 2 && starts[1].misfit_m < starts[0].misfit_m) std::swap(starts[0], starts[1]);
  if (starts.size() == 2) {
    const std::string both = readable(summary.start_mm_fixed, 1) + " mm of misfit with a fixed camera, " +
                             readable(summary.start_mm_moving, 1) + " mm with a moving one";
    const bool clear = starts[0].misfit_m <= kClearly * starts[1].misfit_m;
    if (clear)
      summary.notes.push_back("the camera is taken as " + to_string(starts[0].mount) + ": " + both +
                              "; poses written from flange to base would look the other way round");
    else
      summary.verdict.object(both + ": too near each other to tell which it is",
                             "say which with --camera-mount, and check that poses and images belong together");
  }
  require_meant(starts[0], options.mount.has_value(), data.poses, seen, symmetries);
  return starts[0];
}

// Gives the corners of turned views the order that agrees with the robot.
void reorder(HandEyeData& data, const std::vector<BoardTurn>& turns, const HandEyeStart& start,
             HandEyeSummary& summary) {
  if (turns.size() < 2) return;
  std::string names;
  for (std::size_t v = 0; v < data.corners.views.size(); ++v) {
    const BoardTurn& turn = turns[static_cast<std::size_t>(start.turned[v])];
    summary.views[v].turned = turn.quarter_turns;
    if (turn.quarter_turns == 0) continue;
    names += (names.empty() ? "" : ", ") + data.corners.views[v].name;
    std::vector<Corner>& corners = data.corners.views[v].corners;
    for (Corner& corner : corners) corner.index = turn.order[static_cast<std::size_t>(corner.index)];
    std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) { return a.index < b.index; });
  }
  if (!names.empty())
    summary.notes.push_back(
        "the corners of these views were counted from another corner of the board, as the robot says: " + names);
}

HandEyeState first_state(const HandEyeData& data, const HandEyeOptions& options, const CameraModel& camera,
                         const HandEyeStart& start) {
  HandEyeState state;
  state.mount = start.mount;
  state.camera = camera;
  state.camera_held = options.camera.has_value();
  state.X = to_parameters(start.X);
  state.Y = to_parameters(start.Y);
  state.board_sigma = options.board_sigma;
  state.corrections.assign(data.poses.size(), {});
  state.joint_offsets.assign(static_cast<std::size_t>(data.poses[0].flange_per_joint.cols()), 0.0);
  state.joint_means.assign(state.joint_offsets.size(), 0.0);
  for (std::size_t i = 0; i < std::min(state.joint_means.size(), data.joint_offsets.size()); ++i)
    state.joint_means[i] = -data.joint_offsets[i];
  state.joint_sigma = options.joint_sigma;
  state.sigma_m = std::max(1e-4, start.misfit_m / 2);
  state.sigma_rad = std::max(1e-4, start.misfit_m);
  return state;
}

// Leaves out corners beyond `sigmas` robust standard deviations; how many that are.
int reject_corners(const HandEyeData& data, const HandEyeState& state, double sigmas, HandEyeSelection& selection) {
  std::vector<double> all;
  std::vector<std::vector<double>> sizes(data.poses.size());
  for (std::size_t v = 0; v < data.poses.size(); ++v) {
    if (!selection.used[v]) continue;
    const Vector6d step = Eigen::Map<const Vector6d>(state.corrections[v].data());
    for (const Corner& corner : data.corners.views[v].corners) {
      const auto& p = data.corners.p_board[static_cast<std::size_t>(corner.index)];
      sizes[v].push_back((predicted_pixel(state, data.poses[v], step, p) - corner.pixel).norm() / corner.sigma_px);
      all.push_back(sizes[v].back());
    }
  }
  const double limit = sigmas * robust_sigma_of_lengths(std::move(all));
  int rejected = 0;
  for (std::size_t v = 0; v < data.poses.size(); ++v) {
    for (std::size_t c = 0; c < sizes[v].size(); ++c) {
      selection.keep[v][c] = sizes[v][c] <= limit;
      rejected += !selection.keep[v][c];
    }
  }
  return rejected;
}

// Drops the view whose robot pose had to be corrected by far the most, if there is one.
bool reject_view(const HandEyeData& data, const HandEyeState& state, HandEyeSelection& selection) {
  std::vector<double> turns, shifts;
  std::vector<std::size_t> views;
  for (std::size_t v = 0; v < data.poses.size(); ++v) {
    if (!selection.used[v]) continue;
    const Vector6d left =
        Eigen::Map<const Vector6d>(state.corrections[v].data()) - joint_correction(state, data.poses[v]);
    turns.push_back(left.head<3>().norm()), shifts.push_back(left.tail<3>().norm());
    views.push_back(v);
  }
  if (views.size() <= kFewestViews) return false;
  const double turn = std::max(1e-4, median(turns)), shift = std::max(1e-4, median(shifts));
  std::size_t worst = 0;
  double most = 0;
  for (std::size_t i = 0; i < views.size(); ++i)
    if (const double off = std::max(turns[i] / turn, shifts[i] / shift); off > most) most = off, worst = i;
  if (most < kContradicts) return false;
  selection.used[views[worst]] = false;
  return true;
}

// How far each robot pose that is used had to be corrected: squared, over the noises.
std::vector<double> robot_distances(const HandEyeData& data, const HandEyeSelection& selection,
                                    const HandEyeState& state) {
  std::vector<double> out(data.poses.size(), 0.0);
  for (std::size_t v = 0; v < data.poses.size(); ++v) {
    if (!selection.used[v]) continue;
    const Vector6d left =
        Eigen::Map<const Vector6d>(state.corrections[v].data()) - joint_correction(state, data.poses[v]);
    out[v] = left.head<3>().squaredNorm() / (state.sigma_rad * state.sigma_rad) +
             left.tail<3>().squaredNorm() / (state.sigma_m * state.sigma_m);
  }
  return out;
}

HandEyeCovariance robust_solve(const HandEyeData& data, const HandEyeOptions& options, HandEyeSelection& selection,
                               HandEyeState& state) {
  HandEyeCovariance covariance;
  int rejected = 0;
  for (int round = 0; round < 8; ++round) {
    adjust(data, selection, 4, state, &covariance);
    const bool dropped = reject_view(data, state, selection);
    if (dropped) state.corrections.assign(data.poses.size(), {});
    const int now = dropped ? -1 : reject_corners(data, state, options.reject_sigmas, selection);
    if (now == rejected) break;
    rejected = now;
  }
  adjust(data, selection, 20, state, &covariance);
  const std::vector<double> off = robot_distances(data, selection, state);
  if (*std::max_element(off.begin(), off.end()) < kWildPose) return covariance;
  state.robot_freedom = kWildFreedom;
  adjust(data, selection, 30, state, &covariance);
  return covariance;
}

void require_determined(const HandEyeCovariance& covariance) {
  if (covariance.open > 0)
    throw InputError("--poses", std::to_string(covariance.open) + " parameters of the hand-eye stay open",
                     "add views with other turns of the wrist and tilts of the board");
}

void fill_views(const HandEyeData& data, const HandEyeSelection& selection, const HandEyeState& state,
                HandEyeSummary& summary) {
  double sum = 0, sum_plain = 0;
  int points = 0;
  for (std::size_t v = 0; v < data.poses.size(); ++v) {
    HandEyeView& view = summary.views[v];
    view.used = selection.used[v];
    view.correction = Eigen::Map<const Vector6d>(state.corrections[v].data());
    const Vector6d plain = joint_correction(state, data.poses[v]);
    double view_sum = 0;
    for (std::size_t c = 0; c < data.corners.views[v].corners.size(); ++c) {
      const Corner& corner = data.corners.views[v].corners[c];
      const auto& p = data.corners.p_board[static_cast<std::size_t>(corner.index)];
      view.found_px.push_back(corner.pixel);
      view.residuals_px.push_back(corner.pixel - predicted_pixel(state, data.poses[v], view.correction, p));
      if (!view.used || !selection.keep[v][c]) {
        view.rejected += view.used;
        continue;
      }
      ++view.points;
      view_sum += view.residuals_px.back().squaredNorm();
      sum_plain += (corner.pixel - predicted_pixel(state, data.poses[v], plain, p)).squaredNorm();
    }
    view.rms_px = std::sqrt(view_sum / std::max(1, view.points));
    summary.rejected_points += view.rejected;
    sum += view_sum, points += view.points;
  }
  summary.in_sample_px = std::sqrt(sum / std::max(1, points));
  summary.uncorrected_px = std::sqrt(sum_plain / std::max(1, points));
}

void fill(const HandEyeState& state, const HandEyeCovariance& covariance, HandEyeSummary& summary) {
  summary.mount = state.mount;
  summary.camera = state.camera;
  summary.camera_given = state.camera_held;
  summary.X = to_pose(state.X);
  summary.Y = to_pose(state.Y);
  summary.X_sigma = covariance.X_sigma;
  summary.Y_sigma = covariance.Y_sigma;
  summary.lens_sigma = covariance.lens_sigma;
  summary.joint_offsets = state.joint_offsets;
  summary.joint_offset_sigma = covariance.joint_offset_sigma;
  summary.board_scale = state.board_scale;
  summary.board_scale_sigma = covariance.board_scale_sigma;
  if (std::abs(state.board_scale - 1) > kSizeDoubted * state.board_sigma && state.board_sigma > 0)
    summary.notes.push_back("by the robot, the board has " + readable(state.board_scale, 3) +
                            " times the size that is stated: correct it in --board");
  summary.sigma_px = state.sigma_px;
  summary.sigma_robot_rad = state.sigma_rad;
  summary.sigma_robot_m = state.sigma_m;
  for (std::size_t v = 0; v < state.trust.size(); ++v) {
    summary.views[v].trust = state.trust[v];
    if (state.trust[v] < kHardlyTrusted && summary.views[v].used)
      summary.notes.push_back("the robot pose of view " + summary.views[v].name + " is far off and counts " +
                              readable(state.trust[v], 2) + " times as much as a usual one");
  }
}

}  // namespace

std::string to_string(CameraMount mount) {
  return mount == CameraMount::fixed ? "fixed" : "moving";
}

HandEyeSummary solve_hand_eye(const HandEyeData& given, const HandEyeOptions& options) {
  HandEyeData data = given;
  require_views(data);
  HandEyeSummary summary;
  for (const BoardView& view : data.corners.views) summary.views.emplace_back().name = view.name;
  if (data.poses.size() < kFewViews)
    summary.notes.push_back("only " + counted(data.poses.size(), "view") + ": take 15 or more");

  const CameraModel camera = options.camera ? *options.camera : first_lens(data.corners, options.distortion);
  std::vector<Pose> seen;
  for (const BoardView& view : data.corners.views)
    seen.push_back(board_pose(camera, data.corners.p_board, view).T_camera_board);
  const std::vector<BoardTurn> turns = board_turns(data.corners.p_board, data.cols, data.rows);
  std::vector<Pose> symmetries;
  for (const BoardTurn& turn : turns) symmetries.push_back(turn.T_board_turned);
  const HandEyeStart start = best_start(options, data, seen, symmetries, summary);
  reorder(data, turns, start, summary);

  HandEyeState state = first_state(data, options, camera, start);
  HandEyeSelection selection;
  selection.used = belong_together(start.misfits_m);
  require_enough(data, selection);
  for (const BoardView& view : data.corners.views) selection.keep.emplace_back(view.corners.size(), true);
  HandEyeCovariance covariance;
  try {
    covariance = robust_solve(data, options, selection, state);
  } catch (const RuntimeFailure& failure) {
    summary.camera = camera;
    summary.mount = state.mount;
    judge_unsolved(data, failure.what(), summary);
    return summary;
  }
  require_determined(covariance);
  fill(state, covariance, summary);
  fill_views(data, selection, state, summary);
  if (options.score) score_left_out(data, selection, state, summary);
  judge_hand_eye(data, summary);
  return summary;
}

}  // namespace foresight
