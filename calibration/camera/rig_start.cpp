#include "calibration/camera/rig_start.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/camera/board_pose.hpp"
#include "common/error.hpp"

namespace foresight {
namespace {

constexpr std::size_t kStartViews = 12;

// An error beyond this says no more than that it is wrong.
constexpr double kCap = 0.05;  // of the image's width

double misfit(const CameraRig& rig, const RigViews& views, const std::vector<std::size_t>& trial) {
  double sum = 0;
  const double cap = kCap * views.width[0];
  for (const std::size_t v : trial) {
    const auto pose = find_board_pose(rig, views.p_board, views.views[v], 0, 0);
    const double rms = pose ? std::sqrt(pose->sum_of_squares / pose->corners) : cap;
    sum += std::min(rms, cap) / static_cast<double>(trial.size());
  }
  return sum;
}

std::vector<std::size_t> trial_views(std::size_t count) {
  std::vector<std::size_t> trial;
  const std::size_t n = std::min(count, kStartViews);
  for (std::size_t i = 0; i < n; ++i) trial.push_back(i * count / n);
  return trial;
}

CameraModel plain_camera(const RigViews& views, Distortion distortion, double f) {
  CameraModel camera{views.width[0], views.height[0], distortion, {}};
  camera.lens[0] = camera.lens[1] = f;
  camera.lens[2] = 0.5 * (views.width[0] - 1);
  camera.lens[3] = 0.5 * (views.height[0] - 1);
  return camera;
}

// Difference of two motions as one length: the shift, and the turn at `distance` metres.
double difference(const Pose& a, const Pose& b, double distance) {
  const double angle = Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
  return (a.translation() - b.translation()).norm() + distance * angle;
}

}  // namespace

RigSolution start_camera(const RigViews& views, Distortion distortion) {
  const auto trial = trial_views(views.views.size());
  double best = std::numeric_limits<double>::infinity();
  RigSolution start;
  for (double f = 0.2; f < 6; f *= 1.25) {
    CameraRig rig{{{plain_camera(views, distortion, f * views.width[0])}, Pose::Identity()}, {}};
    const double error = misfit(rig, views, trial);
    if (error < best) best = error, start.rig = rig;
  }
  if (!(best < kCap * views.width[0]))
    throw InputError("calibration", "no focal length explains the corners of any view",
                     "check that --board names the board that was shown, columns before rows");
  for (const RigView& view : views.views) {
    const auto pose = find_board_pose(start.rig, views.p_board, view, 0, 0);
    if (!pose)
      throw InputError("view " + view.name, "its corners lie on a line or outside the lens", "remove this view");
    start.T_left_board.push_back(pose->T_left_board);
  }
  return start;
}

CameraViews views_of(const RigViews& all, int camera) {
  const auto c = static_cast<std::size_t>(camera);
  CameraViews one;
  one.views = {1, {all.width[c], 0}, {all.height[c], 0}, all.p_board, {}};
  for (std::size_t v = 0; v < all.views.size(); ++v) {
    if (all.views[v].corners[c].empty()) continue;
    one.views.views.push_back(RigView{all.views[v].name, {{all.views[v].corners[c], {}}}});
    one.indices.push_back(v);
  }
  return one;
}

RigSolution start_pair(const RigViews& all, const RigSolution& left, const RigSolution& right) {
  const auto left_views = views_of(all, 0).indices, right_views = views_of(all, 1).indices;
  std::vector<const Pose*> T_left(all.views.size()), T_right(all.views.size());
  for (std::size_t i = 0; i < left_views.size(); ++i) T_left[left_views[i]] = &left.T_left_board[i];
  for (std::size_t i = 0; i < right_views.size(); ++i) T_right[right_views[i]] = &right.T_left_board[i];
  std::vector<Pose> motions;
  double distance = 0;
  for (std::size_t v = 0; v < all.views.size(); ++v) {
    if (!T_left[v] || !T_right[v]) continue;
    motions.push_back(*T_left[v] * T_right[v]->inverse());
    distance += T_left[v]->translation().norm();
  }
  if (motions.empty())
    throw InputError("pairs", "no view was seen by both cameras", "show the board where both cameras see it");
  distance /= static_cast<double>(motions.size());
  RigSolution start;
  start.rig = {{{left.rig.cameras[0], right.rig.cameras[0]}, Pose::Identity()}, left.rig.warp};
  double best = std::numeric_limits<double>::infinity();
  for (const Pose& candidate : motions) {
    double sum = 0;
    for (const Pose& other : motions) sum += difference(candidate, other, distance);
    if (sum < best) best = sum, start.rig.T_left_right = candidate;
  }
  for (std::size_t v = 0; v < all.views.size(); ++v)
    start.T_left_board.push_back(T_left[v] ? *T_left[v] : Pose(start.rig.T_left_right * *T_right[v]));
  return start;
}

RigSolution solve_alone(const RigViews& all, int camera, Distortion distortion, const RigSolverOptions& options) {
  const CameraViews one = views_of(all, camera);
  RigSolverOptions flat = options;
  flat.warp = false;
  return solve_rig(one.views, start_camera(one.views, distortion), flat);
}

RigSolution solve_from_nothing(const RigViews& all, Distortion distortion, const RigSolverOptions& options) {
  const RigSolution left = solve_alone(all, 0, distortion, options);
  if (all.cameras == 1) return solve_rig(all, left, options);
  return solve_rig(all, start_pair(all, left, solve_alone(all, 1, distortion, options)), options);
}

}  // namespace foresight
