#include "calibration/robot/pose_reading.hpp"

#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr double kFitsInstead = 0.25;  // of the misfit
// How far the flange moves over how far camera and board move: its lever arms allow some tens, a unit takes thousands.
constexpr double kOtherUnit = 100;
constexpr double kTurnsOnly = 1e-3;  // metres: a robot that moved less may have turned its wrist only
constexpr double kOtherSize = 0.1;   // of the board: less, the solver finds by itself

double spread(const std::vector<Pose>& poses) {
  std::vector<double> x, y, z, off;
  for (const Pose& pose : poses)
    x.push_back(pose.translation().x()), y.push_back(pose.translation().y()), z.push_back(pose.translation().z());
  const Eigen::Vector3d middle(median(x), median(y), median(z));
  for (const Pose& pose : poses) off.push_back((pose.translation() - middle).norm());
  return median(off);
}

void require_one_unit(std::span<const RobotPose> poses, std::span<const Pose> T_camera_board) {
  std::vector<Pose> flange, board, camera;
  for (const RobotPose& pose : poses) flange.push_back(pose.T_base_flange);
  for (const Pose& pose : T_camera_board) board.push_back(pose), camera.push_back(pose.inverse());
  const double robot = spread(flange), seen = std::max(spread(board), spread(camera));
  const std::string both =
      "the robot moved by " + readable(robot, 4) + " m, the images show " + readable(seen, 4) + " m";
  if (robot > kOtherUnit * seen)
    throw InputError("--poses", both + ": the positions are not metres, or the board is larger than it says",
                     "say --pose-unit mm, or correct the size in --board (metres)");
  if (robot > kTurnsOnly && seen > kOtherUnit * robot)
    throw InputError("--board", both + ": its size is not in metres, or the positions are larger than they say",
                     "correct the size in --board (metres), or say --pose-unit m");
}

std::vector<RobotPose> with_rotations(std::span<const RobotPose> poses,
                                      Eigen::Matrix3d (*meant)(const Eigen::Matrix3d& read)) {
  std::vector<RobotPose> out(poses.begin(), poses.end());
  for (RobotPose& pose : out) pose.T_base_flange.linear() = meant(pose.T_base_flange.linear());
  return out;
}

Eigen::Matrix3d w_first(const Eigen::Matrix3d& read) {
  const Eigen::Quaterniond q(read);
  return Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w()).toRotationMatrix();
}

Eigen::Matrix3d transposed(const Eigen::Matrix3d& read) {
  return read.transpose();
}

/// Seen in a mirror: what is seen right of the middle stands left of it, and so do the board's own points.
std::vector<Pose> mirrored(std::span<const Pose> poses) {
  const Eigen::DiagonalMatrix<double, 3> mirror(-1, 1, 1);
  std::vector<Pose> out(poses.begin(), poses.end());
  for (Pose& pose : out) {
    pose.linear() = mirror * pose.linear() * mirror;
    pose.translation() = mirror * pose.translation();
  }
  return out;
}

std::string instead(double misfit_m, double other_m) {
  return readable(1e3 * other_m, 1) + " mm of misfit instead of " + readable(1e3 * misfit_m, 1) + " mm";
}

/// True over stated size of the board, as the robot measures it: with the turns of `start`, which do not depend on it,
/// F Y = X B is linear in the shifts of X and Y and in the size.
double size_by_robot(const HandEyeStart& start, std::span<const RobotPose> poses,
                     std::span<const Pose> T_camera_board) {
  const auto rows = 3 * static_cast<Eigen::Index>(poses.size());
  Eigen::Matrix<double, Eigen::Dynamic, 7> A(rows, 7);
  Eigen::VectorXd b(rows);
  for (std::size_t v = 0; v < poses.size(); ++v) {
    const Pose& T = poses[v].T_base_flange;
    const Pose F = start.mount == CameraMount::moving ? T.inverse() : T;
    const auto row = 3 * static_cast<Eigen::Index>(v);
    A.middleRows<3>(row) << F.linear(), -Eigen::Matrix3d::Identity(),
        -start.X.linear() * T_camera_board[v].translation();
    b.segment<3>(row) = -F.translation();
  }
  return A.colPivHouseholderQr().solve(b)[6];
}

std::vector<Pose> with_size(std::span<const Pose> poses, double size) {
  std::vector<Pose> out(poses.begin(), poses.end());
  for (Pose& pose : out) pose.translation() *= size;
  return out;
}

void require_size(const HandEyeStart& start, std::span<const RobotPose> poses, std::span<const Pose> T_camera_board,
                  std::span<const Pose> symmetries) {
  std::vector<Pose> turned;
  for (std::size_t v = 0; v < T_camera_board.size(); ++v)
    turned.push_back(T_camera_board[v] * symmetries[static_cast<std::size_t>(start.turned[v])]);
  const double size = size_by_robot(start, poses, turned);
  if (!(size > 0) || std::abs(size - 1) < kOtherSize) return;
  const double m =
      start_hand_eye(start.mount, poses, with_size(T_camera_board, size), with_size(symmetries, size)).misfit_m;
  if (m < kFitsInstead * start.misfit_m)
    throw InputError("--board",
                     "by the robot's motion it has " + readable(size, 3) +
                         " times the size that is stated: " + instead(start.misfit_m, m),
                     "measure its squares (or tags), and correct the size in --board");
}

}  // namespace

void require_meant(const HandEyeStart& start, bool forced, std::span<const RobotPose> poses,
                   std::span<const Pose> T_camera_board, std::span<const Pose> symmetries) {
  require_one_unit(poses, T_camera_board);
  const auto misfit = [&](CameraMount mount, std::span<const RobotPose> of) {
    return start_hand_eye(mount, of, T_camera_board, symmetries).misfit_m;
  };
  const std::vector<Pose> through_mirror = mirrored(T_camera_board);
  if (const double m = start_hand_eye(start.mount, poses, through_mirror, mirrored(symmetries)).misfit_m;
      m < kFitsInstead * start.misfit_m)
    throw InputError("--images", "the pictures seem to be mirrored: " + instead(start.misfit_m, m),
                     "switch off the mirroring of the camera or of the program that took them, and take them again");
  const CameraMount other = start.mount == CameraMount::fixed ? CameraMount::moving : CameraMount::fixed;
  if (forced)
    if (const double m = misfit(other, poses); m < kFitsInstead * start.misfit_m)
      throw InputError("--camera-mount " + to_string(start.mount),
                       "contradicts images and poses: with a " + to_string(other) + " camera there are " +
                           instead(start.misfit_m, m),
                       "say --camera-mount " + to_string(other) + "; or, where the camera is " +
                           to_string(start.mount) +
                           " indeed, the poses are written from flange to base: say --invert-poses");
  const auto read_as = [&](Eigen::Matrix3d (*meant)(const Eigen::Matrix3d&)) {
    const std::vector<RobotPose> turned = with_rotations(poses, meant);
    return forced ? misfit(start.mount, turned) : std::min(misfit(start.mount, turned), misfit(other, turned));
  };
  if (const double m = read_as(w_first); m < kFitsInstead * start.misfit_m)
    throw InputError("--poses", "the quaternions seem to be written qw qx qy qz: " + instead(start.misfit_m, m),
                     "write them as qx qy qz qw");
  if (const double m = read_as(transposed); m < kFitsInstead * start.misfit_m)
    throw InputError("--poses", "the rotations seem to be transposed: " + instead(start.misfit_m, m),
                     "write matrices row by row, and quaternions of the turn from base to flange");
  require_size(start, poses, T_camera_board, symmetries);
}

}  // namespace foresight
