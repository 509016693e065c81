#include "calibration/camera/held_out.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>

#include "calibration/camera/board_pose.hpp"

namespace foresight {
namespace {

struct Sums {
  double joint = 0, cross = 0, epipolar = 0;
  int joint_points = 0, cross_points = 0, epipolar_points = 0, views = 0;

  HeldOutScore score() const {
    HeldOutScore score;
    score.joint_px = std::sqrt(joint / std::max(1, joint_points));
    score.cross_px = std::sqrt(cross / std::max(1, cross_points));
    score.epipolar_px = epipolar / std::max(1, epipolar_points);
    score.views = views;
    return score;
  }
};

std::optional<BoardPose> find_joint_pose(const CameraRig& rig, const std::vector<Eigen::Vector3d>& points,
                                         const RigView& view) {
  const int first = view.corners[0].empty() ? 1 : 0;
  return find_board_pose(rig, points, view, first, view.both() ? 1 : first);
}

// As if the board stood in one camera only, predicted in the other.
void add_cross(const CameraRig& rig, const std::vector<Eigen::Vector3d>& points, const RigView& view, int from,
               Sums& sums) {
  const auto pose = find_board_pose(rig, points, view, from, from);
  if (!pose) return;
  const int to = 1 - from;
  const auto t = static_cast<std::size_t>(to);
  for (const Corner& corner : view.corners[t]) {
    const Eigen::Vector3d p_left = pose->T_left_board * points[static_cast<std::size_t>(corner.index)];
    const auto pixel = project(rig.cameras[t], to_camera(rig, to, p_left));
    if (!pixel) continue;
    sums.cross += (*pixel - corner.pixel).squaredNorm();
    ++sums.cross_points;
  }
}

Eigen::Matrix3d camera_matrix(const CameraModel& camera) {
  Eigen::Matrix3d K = Eigen::Matrix3d::Identity();
  K(0, 0) = camera.lens[0], K(1, 1) = camera.lens[1], K(0, 2) = camera.lens[2], K(1, 2) = camera.lens[3];
  return K;
}

double distance_px(const CameraModel& camera, const Eigen::Vector3d& ray, const Eigen::Vector3d& normal) {
  const Eigen::Matrix3d K = camera_matrix(camera);
  const Eigen::Vector3d line = K.inverse().transpose() * normal;
  return std::abs(line.dot(K * (ray / ray.z()))) / line.head<2>().norm();
}

void add_epipolar(const CameraRig& rig, const RigView& view, Sums& sums) {
  std::map<int, Eigen::Vector2d> right;
  for (const Corner& corner : view.corners[1]) right[corner.index] = corner.pixel;
  const Pose& T = rig.T_left_right;
  for (const Corner& corner : view.corners[0]) {
    const auto other = right.find(corner.index);
    if (other == right.end()) continue;
    const auto left_ray = unproject(rig.cameras[0], corner.pixel);
    const auto right_ray = unproject(rig.cameras[1], other->second);
    if (!left_ray || !right_ray || left_ray->z() < 0.05 || right_ray->z() < 0.05) continue;
    const Eigen::Vector3d normal_left = T.translation().cross(T.linear() * *right_ray);
    const Eigen::Vector3d normal_right = T.linear().transpose() * T.translation().cross(*left_ray);
    sums.epipolar += distance_px(rig.cameras[0], *left_ray, normal_left);
    sums.epipolar += distance_px(rig.cameras[1], *right_ray, normal_right);
    sums.epipolar_points += 2;
  }
}

std::optional<BoardPose> add_view(const CameraRig& rig, const std::vector<Eigen::Vector3d>& points, const RigView& view,
                                  Sums& sums) {
  const auto joint = find_joint_pose(rig, points, view);
  if (!joint) return joint;
  ++sums.views;
  sums.joint += joint->sum_of_squares;
  sums.joint_points += joint->corners;
  if (!view.both()) return joint;
  add_cross(rig, points, view, 0, sums);
  add_cross(rig, points, view, 1, sums);
  add_epipolar(rig, view, sums);
  return joint;
}

// One view, the rig that has not seen it, and where the board stands for the corners that count.
struct PlacedView {
  RigViews one;
  RigSolution solution;

  const RigView& view() const { return one.views.front(); }

  bool place(const RigView& by) {
    const auto pose = find_joint_pose(solution.rig, warped(one.p_board, solution.rig.warp), by);
    if (pose) solution.T_left_board = {pose->T_left_board};
    return pose.has_value();
  }
};

std::size_t corners_of(const RigView& view) {
  return view.corners[0].size() + view.corners[1].size();
}

double worst_px(const PlacedView& placed, const OutlierBound& bound) {
  const RigErrors errors = rig_errors(placed.one, placed.solution);
  double worst = 0;
  for (std::size_t c = 0; c < 2; ++c)
    for (std::size_t i = 0; i < errors[0][c].size(); ++i)
      worst = std::max(worst, bound.weighted_px(placed.view().corners[c][i], errors[0][c][i].norm()));
  return worst;
}

// The corners whose weighted error is no larger than `limit_px`.
RigView within(const PlacedView& placed, const OutlierBound& bound, double limit_px) {
  const RigErrors errors = rig_errors(placed.one, placed.solution);
  RigView some{placed.view().name, {}};
  for (std::size_t c = 0; c < 2; ++c)
    for (std::size_t i = 0; i < errors[0][c].size(); ++i) {
      const Corner& corner = placed.view().corners[c][i];
      if (bound.weighted_px(corner, errors[0][c][i].norm()) <= limit_px) some.corners[c].push_back(corner);
    }
  return some;
}

// Without wrong corners. One that is far off draws the pose, and good corners seem wrong: the limit comes down to the
// bound by halves. Where half of the corners would go, it is the view or the rig that is wrong: all of them count.
RigView inliers(PlacedView& placed, const OutlierBound& bound) {
  const PlacedView before = placed;
  double limit = worst_px(placed, bound);
  if (!(bound.px > 0 && limit > bound.px)) return placed.view();
  do {
    limit = std::isfinite(limit) ? std::max(bound.px, limit / 2) : 1e6 * bound.px;
    const RigView some = within(placed, bound, limit);
    if (2 * corners_of(some) <= corners_of(placed.view()) || !placed.place(some)) {
      placed = before;
      return placed.view();
    }
  } while (limit > bound.px);
  return within(placed, bound, bound.px);
}

/// The score of views left out, over all corners and without the wrong ones.
class Scores {
 public:
  explicit Scores(const RigViews& test) : test_(test), all_(subset(test, {})) {}

  void add(const CameraRig& rig, const RigView& view) {
    PlacedView placed{subset(test_, {}), {}};
    placed.one.views = {view};
    placed.solution.rig = rig;
    if (const auto joint = add_view(rig, warped(test_.p_board, rig.warp), view, sums_)) {
      placed.solution.T_left_board = {joint->T_left_board};
      all_.views.push_back(view);
      placed_.push_back(std::move(placed));
    }
  }

  HeldOutScore score(double reject_sigmas) {
    RigViews counted = all_;
    for (int round = 0; round < kRounds; ++round) {
      RigErrors errors;
      for (const PlacedView& placed : placed_) errors.push_back(rig_errors(placed.one, placed.solution).front());
      const OutlierBound bound = outlier_bound(all_, errors, reject_sigmas);
      for (std::size_t v = 0; v < placed_.size(); ++v) counted.views[v] = inliers(placed_[v], bound);
    }
    HeldOutScore score = sums_.score();
    Sums sums;
    for (std::size_t v = 0; v < placed_.size(); ++v) {
      const CameraRig& rig = placed_[v].solution.rig;
      add_view(rig, warped(test_.p_board, rig.warp), counted.views[v], sums);
      score.rejected_points += static_cast<int>(corners_of(all_.views[v]) - corners_of(counted.views[v]));
    }
    const HeldOutScore inlier = sums.score();
    score.joint_inlier_px = inlier.joint_px;
    score.cross_inlier_px = inlier.cross_px;
    score.epipolar_inlier_px = inlier.epipolar_px;
    return score;
  }

 private:
  static constexpr int kRounds = 2;  // the second bound is of poses that wrong corners no longer draw

  const RigViews& test_;
  Sums sums_;
  RigViews all_;  ///< those that could be placed
  std::vector<PlacedView> placed_;
};

}  // namespace

HeldOutScore score_views(const CameraRig& rig, const RigViews& test, double reject_sigmas) {
  Scores scores(test);
  for (const RigView& view : test.views) scores.add(rig, view);
  return scores.score(reject_sigmas);
}

LeaveOut leave_out(const RigViews& train, const RigViews& test, const RigSolution& solution,
                   const RigSolverOptions& options, int most_folds) {
  std::map<std::string, const RigView*> tests;
  for (const RigView& view : test.views) tests[view.name] = &view;
  const std::size_t n = train.views.size();
  const std::size_t folds = std::min(n, static_cast<std::size_t>(std::max(2, most_folds)));
  Scores scores(test);
  for (std::size_t fold = 0; fold < folds; ++fold) {
    std::vector<std::size_t> kept;
    for (std::size_t v = 0; v < n; ++v)
      if (v % folds != fold) kept.push_back(v);
    const RigViews some = subset(train, kept);
    const CameraRig rig = solve_rig(some, subset(solution, kept), options).rig;
    for (std::size_t v = fold; v < n; v += folds)
      if (const auto found = tests.find(train.views[v].name); found != tests.end()) scores.add(rig, *found->second);
  }
  return {scores.score(options.reject_sigmas), static_cast<int>(folds)};
}

}  // namespace foresight
