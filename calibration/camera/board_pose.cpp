#include "calibration/camera/board_pose.hpp"

#include <opencv2/calib3d.hpp>

#include "calibration/camera/pose_solver.hpp"

namespace foresight {
namespace {

// Adds what the corners say; `T` is T_left_board.
bool add_corners(const CameraRig& rig, const std::vector<Eigen::Vector3d>& p_board, const RigView& view, int first,
                 int last, const Pose& T, bool derivatives, PoseEquations<0>& sum) {
  for (int camera = first; camera <= last; ++camera) {
    const auto c = static_cast<std::size_t>(camera);
    const Eigen::Matrix3d R_camera_board =
        camera == 1 ? Eigen::Matrix3d(rig.T_left_right.linear().transpose() * T.linear()) : Eigen::Matrix3d(T.linear());
    for (const Corner& corner : view.corners[c]) {
      const Eigen::Vector3d& p = p_board[static_cast<std::size_t>(corner.index)];
      Eigen::Matrix<double, 2, 3> d;
      const auto pixel = project(rig.cameras[c], to_camera(rig, camera, T * p), derivatives ? &d : nullptr);
      if (!pixel) return false;
      const Eigen::Vector2d error = *pixel - corner.pixel;
      sum.cost += error.squaredNorm() / 2;
      if (!derivatives) continue;
      d = (d * R_camera_board).eval();
      Eigen::Matrix<double, 2, 6> J;
      for (int row = 0; row < 2; ++row) J.row(row).head<3>() = p.cross(d.row(row).transpose()).transpose();
      J.rightCols<3>() = d;
      sum.H.noalias() += J.transpose() * J;
      sum.g.noalias() += J.transpose() * error;
    }
  }
  return true;
}

std::vector<Pose> planar_starts(const CameraModel& camera, const std::vector<Eigen::Vector3d>& p_board,
                                const std::vector<Corner>& corners) {
  constexpr double kSteepest = 0.15;  // z of a unit ray; beyond, x / z says little
  std::vector<cv::Point3d> object;
  std::vector<cv::Point2d> image;
  for (const Corner& corner : corners) {
    const auto ray = unproject(camera, corner.pixel);
    if (!ray || ray->z() < kSteepest) continue;
    const Eigen::Vector3d& p = p_board[static_cast<std::size_t>(corner.index)];
    object.emplace_back(p.x(), p.y(), 0);
    image.emplace_back(ray->x() / ray->z(), ray->y() / ray->z());
  }
  std::vector<Pose> poses;
  if (object.size() < 4) return poses;
  std::vector<cv::Mat> turns, shifts;
  try {
    cv::solvePnPGeneric(object, image, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), turns, shifts, false,
                        cv::SOLVEPNP_IPPE);
  } catch (const cv::Exception&) {
    return poses;  // points in a line
  }
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const Eigen::Vector3d turn(turns[i].at<double>(0), turns[i].at<double>(1), turns[i].at<double>(2));
    Pose T = Pose::Identity();
    if (turn.norm() > 0) T.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    T.translation() = Eigen::Vector3d(shifts[i].at<double>(0), shifts[i].at<double>(1), shifts[i].at<double>(2));
    if (T.matrix().allFinite()) poses.push_back(T);
  }
  return poses;
}

}  // namespace

std::optional<BoardPose> refine_board_pose(const CameraRig& rig, const std::vector<Eigen::Vector3d>& p_board,
                                           const RigView& view, int first, int last, const Pose& start) {
  int corners = 0;
  for (int camera = first; camera <= last; ++camera)
    corners += static_cast<int>(view.corners[static_cast<std::size_t>(camera)].size());
  const auto problem = [&](const PoseEstimate<0>& at, bool derivatives, PoseEquations<0>& sum) {
    return add_corners(rig, p_board, view, first, last, at.T, derivatives, sum);
  };
  PoseSolverOptions<0> options;
  options.base = start;
  options.most_iterations = 60;
  const PoseSolution<0> found = solve_pose<0>({start, {}}, problem, options);
  if (corners == 0 || !found.usable) return std::nullopt;
  PoseEquations<0> end;
  problem(found.at, false, end);
  return BoardPose{found.at.T, 2 * end.cost, corners};
}

std::optional<BoardPose> find_board_pose(const CameraRig& rig, const std::vector<Eigen::Vector3d>& p_board,
                                         const RigView& view, int first, int last) {
  const auto c = static_cast<std::size_t>(first);
  std::optional<BoardPose> best;
  for (const Pose& T_camera_board : planar_starts(rig.cameras[c], p_board, view.corners[c])) {
    const Pose T_left_board = first == 0 ? T_camera_board : Pose(rig.T_left_right * T_camera_board);
    const auto found = refine_board_pose(rig, p_board, view, first, last, T_left_board);
    if (found && (!best || found->sum_of_squares < best->sum_of_squares)) best = found;
  }
  return best;
}

}  // namespace foresight
