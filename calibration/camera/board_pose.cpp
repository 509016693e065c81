#include "calibration/camera/board_pose.hpp"

#include <Eigen/Cholesky>
#include <limits>
#include <opencv2/calib3d.hpp>

namespace foresight {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

struct Normal {
  Matrix6 A = Matrix6::Zero();
  Vector6 b = Vector6::Zero();
  double sum = 0;
  int corners = 0;
};

// Normal equations after a small turn about the board's origin and a shift, both in left coordinates.
bool accumulate(const CameraRig& rig, const std::vector<Eigen::Vector3d>& p_board, const RigView& view, int first,
                int last, const Pose& T_left_board, Normal& normal) {
  const Eigen::Matrix3d R_right_left = rig.T_left_right.linear().transpose();
  for (int camera = first; camera <= last; ++camera) {
    const auto c = static_cast<std::size_t>(camera);
    for (const Corner& corner : view.corners[c]) {
      const Eigen::Vector3d turned = T_left_board.linear() * p_board[static_cast<std::size_t>(corner.index)];
      const Eigen::Vector3d p_left = turned + T_left_board.translation();
      Eigen::Matrix<double, 2, 3> d;
      const auto pixel = project(rig.cameras[c], to_camera(rig, camera, p_left), &d);
      if (!pixel) return false;
      if (camera == 1) d = (d * R_right_left).eval();
      Eigen::Matrix<double, 2, 6> J;
      for (int row = 0; row < 2; ++row) J.row(row).head<3>() = turned.cross(d.row(row).transpose()).transpose();
      J.rightCols<3>() = d;
      const Eigen::Vector2d error = *pixel - corner.pixel;
      normal.A.noalias() += J.transpose() * J;
      normal.b.noalias() += J.transpose() * error;
      normal.sum += error.squaredNorm();
      ++normal.corners;
    }
  }
  return true;
}

Pose stepped(const Pose& T, const Vector6& step) {
  Pose result = T;
  const double angle = step.head<3>().norm();
  if (angle > 0) result.linear() = Eigen::AngleAxisd(angle, step.head<3>() / angle).toRotationMatrix() * T.linear();
  result.translation() += step.tail<3>();
  return result;
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
  Pose T = start;
  Normal at;
  if (!accumulate(rig, p_board, view, first, last, T, at) || at.corners == 0) return std::nullopt;
  double damping = 1e-6;
  for (int i = 0; i < 60; ++i) {
    Matrix6 A = at.A;
    A.diagonal() *= 1 + damping;
    const Vector6 step = -A.ldlt().solve(at.b);
    const Pose trial = stepped(T, step);
    Normal next;
    if (step.allFinite() && accumulate(rig, p_board, view, first, last, trial, next) && next.sum <= at.sum) {
      const bool done = at.sum - next.sum <= 1e-12 * at.sum;
      T = trial, at = next;
      damping = std::max(damping * 0.1, 1e-12);
      if (done) break;
    } else {
      damping *= 30;
      if (damping > 1e9) break;
    }
  }
  return BoardPose{T, at.sum, at.corners};
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
