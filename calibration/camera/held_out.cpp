#include "calibration/camera/held_out.hpp"

#include <Eigen/LU>
#include <cmath>
#include <map>

#include "calibration/camera/board_pose.hpp"

namespace foresight {
namespace {

struct Sums {
  double joint = 0, cross = 0, epipolar = 0;
  int joint_points = 0, cross_points = 0, epipolar_points = 0, views = 0;

  HeldOutScore score() const {
    return {std::sqrt(joint / std::max(1, joint_points)), std::sqrt(cross / std::max(1, cross_points)),
            epipolar / std::max(1, epipolar_points), views};
  }
};

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

void add_view(const CameraRig& rig, const std::vector<Eigen::Vector3d>& points, const RigView& view, Sums& sums) {
  const int first = view.corners[0].empty() ? 1 : 0;
  const int last = view.both() ? 1 : first;
  const auto joint = find_board_pose(rig, points, view, first, last);
  if (!joint) return;
  ++sums.views;
  sums.joint += joint->sum_of_squares;
  sums.joint_points += joint->corners;
  if (!view.both()) return;
  add_cross(rig, points, view, 0, sums);
  add_cross(rig, points, view, 1, sums);
  add_epipolar(rig, view, sums);
}

RigSolution without_views(const RigSolution& all, const std::vector<std::size_t>& kept) {
  RigSolution some = all;
  some.rejected.clear();
  some.T_left_board.clear();
  for (const std::size_t v : kept) some.T_left_board.push_back(all.T_left_board[v]);
  return some;
}

}  // namespace

HeldOutScore score_views(const CameraRig& rig, const RigViews& test) {
  Sums sums;
  const auto points = warped(test.p_board, rig.warp);
  for (const RigView& view : test.views) add_view(rig, points, view, sums);
  return sums.score();
}

LeaveOut leave_out(const RigViews& train, const RigViews& test, const RigSolution& solution,
                   const RigSolverOptions& options, int most_folds) {
  std::map<std::string, const RigView*> tests;
  for (const RigView& view : test.views) tests[view.name] = &view;
  const std::size_t n = train.views.size();
  const std::size_t folds = std::min(n, static_cast<std::size_t>(std::max(2, most_folds)));
  Sums sums;
  for (std::size_t fold = 0; fold < folds; ++fold) {
    std::vector<std::size_t> kept;
    for (std::size_t v = 0; v < n; ++v)
      if (v % folds != fold) kept.push_back(v);
    const RigViews some = subset(train, kept);
    const RigSolution solved = solve_rig(some, without_views(solution, kept), options);
    const auto points = warped(test.p_board, solved.rig.warp);
    for (std::size_t v = fold; v < n; v += folds)
      if (const auto found = tests.find(train.views[v].name); found != tests.end())
        add_view(solved.rig, points, *found->second, sums);
  }
  return {sums.score(), static_cast<int>(folds)};
}

}  // namespace foresight
