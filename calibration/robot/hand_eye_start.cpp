#include "calibration/robot/hand_eye_start.hpp"

#include <algorithm>
#include <numeric>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <random>

#include "calibration/robot/motion_check.hpp"
#include "common/error.hpp"

namespace foresight {
namespace {

constexpr int kTrials = 100;            // of three views; of these, half are right where a fifth of all views is wrong
constexpr double kTurnOfThree = 0.087;  // rad: below 5 degrees noise decides

struct Points {
  std::vector<cv::Point3d> board;
  std::vector<cv::Point2d> image;
};

Points points_of(const std::vector<Eigen::Vector3d>& p_board, const BoardView& view) {
  Points points;
  for (const Corner& corner : view.corners) {
    const Eigen::Vector3d& p = p_board[static_cast<std::size_t>(corner.index)];
    points.board.emplace_back(p.x(), p.y(), p.z());
    points.image.emplace_back(corner.pixel.x(), corner.pixel.y());
  }
  return points;
}

Pose to_pose(const cv::Mat& R, const cv::Mat& t) {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
  cv::cv2eigen(R, rotation);
  cv::cv2eigen(t, translation);
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
  pose.translation() = translation;
  return pose;
}

// Rays of the corners through the lens, on the plane z = 1.
std::vector<cv::Point2d> normalised(const CameraModel& camera, const std::vector<cv::Point2d>& pixels) {
  const LensParameters& l = camera.lens;
  const cv::Matx33d K(l[0], 0, l[2], 0, l[1], l[3], 0, 0, 1);
  std::vector<cv::Point2d> rays;
  if (camera.distortion == Distortion::equidistant) {
    cv::fisheye::undistortPoints(pixels, rays, K, cv::Mat(4, 1, CV_64F, const_cast<double*>(l.data() + 4)));
  } else {
    const cv::Mat d(12, 1, CV_64F, const_cast<double*>(l.data() + 4));
    cv::undistortPoints(pixels, rays, K, d, cv::noArray(), cv::noArray(),
                        cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 50, 1e-12));
  }
  return rays;
}

/// The robot's pose, or its inverse, as it stands between X and the board's pose.
Pose of_robot(CameraMount mount, const Pose& T_base_flange) {
  return mount == CameraMount::moving ? T_base_flange : T_base_flange.inverse();
}

Pose park(CameraMount mount, std::span<const Pose> T_base_flange, std::span<const Pose> T_camera_board) {
  std::vector<cv::Mat> Ra, ta, Rb, tb;
  for (std::size_t i = 0; i < T_base_flange.size(); ++i) {
    const Pose A = of_robot(mount, T_base_flange[i]);
    for (const auto& [T, R, t] : {std::tie(A, Ra, ta), std::tie(T_camera_board[i], Rb, tb)}) {
      cv::Mat rotation, translation;
      cv::eigen2cv(Eigen::Matrix3d(T.linear()), rotation);
      cv::eigen2cv(Eigen::Vector3d(T.translation()), translation);
      R.push_back(rotation), t.push_back(translation);
    }
  }
  cv::Mat R, t;
  cv::calibrateHandEye(Ra, ta, Rb, tb, R, t, cv::CALIB_HAND_EYE_PARK);
  return to_pose(R, t);
}

std::vector<Pose> base_or_flange_boards(CameraMount mount, std::span<const Pose> T_base_flange, const Pose& X,
                                        std::span<const Pose> T_camera_board) {
  std::vector<Pose> out;
  for (std::size_t i = 0; i < T_base_flange.size(); ++i)
    out.push_back(of_robot(mount, T_base_flange[i]) * X * T_camera_board[i]);
  return out;
}

std::vector<double> misfits(const HandEyeStart& start, std::span<const Pose> T_base_flange,
                            std::span<const Pose> seen) {
  std::vector<double> out;
  for (std::size_t i = 0; i < seen.size(); ++i)
    out.push_back(misfit_m(predicted_board(start.mount, T_base_flange[i], start.X, start.Y), seen[i]));
  return out;
}

// Closed form of the views `F` and `B`, then again of those of all that fit it, up to three times.
HandEyeStart fit(CameraMount mount, std::span<const Pose> T_base_flange, std::span<const Pose> seen,
                 std::vector<Pose> F, std::vector<Pose> B) {
  HandEyeStart start;
  start.mount = mount;
  for (int round = 0; round < 3; ++round) {
    start.X = park(mount, F, B);
    start.Y = typical_pose(base_or_flange_boards(mount, F, start.X, B));
    start.misfits_m = misfits(start, T_base_flange, seen);
    start.misfit_m = median(start.misfits_m);
    std::vector<Pose> F_good, B_good;
    for (std::size_t i = 0; i < seen.size(); ++i)
      if (start.misfits_m[i] < 4 * start.misfit_m) F_good.push_back(T_base_flange[i]), B_good.push_back(seen[i]);
    if (F_good.size() == F.size() || F_good.size() < 4) break;
    F = F_good, B = B_good;
  }
  return start;
}

HandEyeStart fit(CameraMount mount, std::span<const Pose> F, std::span<const Pose> seen) {
  return fit(mount, F, seen, {F.begin(), F.end()}, {seen.begin(), seen.end()});
}

// From the three views whose closed form fits half of all views best (least median of squares, Rousseeuw 1984): poses
// that belong to other images draw a closed form of all views so far that they no longer stand out from it.
HandEyeStart of_the_best_three(CameraMount mount, std::span<const Pose> F, std::span<const Pose> seen) {
  std::mt19937 random(1);
  std::vector<std::size_t> order(F.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  HandEyeStart best;
  best.misfit_m = 1e300;
  for (int trial = 0; trial < kTrials; ++trial) {
    for (std::size_t i = 0; i < 3; ++i) std::swap(order[i], order[i + random() % (order.size() - i)]);
    std::vector<Pose> some_F, some_B;
    for (std::size_t i = 0; i < 3; ++i) some_F.push_back(F[order[i]]), some_B.push_back(seen[order[i]]);
    if (motion_spread(some_F).second_axis_rad < kTurnOfThree) continue;
    HandEyeStart start;
    start.mount = mount;
    start.X = park(mount, some_F, some_B);
    if (!start.X.matrix().allFinite()) continue;
    start.Y = typical_pose(base_or_flange_boards(mount, some_F, start.X, some_B));
    start.misfits_m = misfits(start, F, seen);
    start.misfit_m = median(start.misfits_m);
    if (start.misfit_m < best.misfit_m) best = std::move(start);
  }
  if (best.misfits_m.empty()) return best;
  std::vector<Pose> fitting_F, fitting_B;
  for (std::size_t i = 0; i < F.size(); ++i)
    if (best.misfits_m[i] <= 2 * best.misfit_m) fitting_F.push_back(F[i]), fitting_B.push_back(seen[i]);
  return fitting_F.size() < 4 ? best : fit(mount, F, seen, fitting_F, fitting_B);
}

// Angle and shift along the axis of a motion are the same in every frame that is fixed to its body.
Eigen::Vector2d invariants(const Pose& from, const Pose& to) {
  const Pose motion = from.inverse() * to;
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(motion.linear()));
  return {turn.angle(), turn.angle() > 0.1 ? turn.axis().dot(motion.translation()) : 0.0};
}

// For each view the symmetry whose motion from `anchor` is most like the robot's.
std::vector<std::size_t> turns_like_robot(CameraMount mount, std::span<const Pose> F, std::span<const Pose> seen,
                                          std::span<const Pose> symmetries, std::size_t anchor) {
  std::vector<std::size_t> best(seen.size(), 0);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Eigen::Vector2d truth = invariants(of_robot(mount, F[anchor]), of_robot(mount, F[i]));
    double least = 1e300;
    for (std::size_t k = 0; k < symmetries.size(); ++k) {
      const Eigen::Vector2d off = invariants(seen[anchor].inverse(), (seen[i] * symmetries[k]).inverse()) - truth;
      const double cost = std::abs(off[0]) + 2 * std::abs(off[1]);
      if (cost < least - 1e-9) least = cost, best[i] = k;
    }
  }
  return best;
}

std::vector<Pose> turned(std::span<const Pose> seen, std::span<const Pose> symmetries,
                         const std::vector<std::size_t>& k) {
  std::vector<Pose> out;
  for (std::size_t i = 0; i < seen.size(); ++i) out.push_back(seen[i] * symmetries[k[i]]);
  return out;
}

// Alternates between the hand-eye and each view's symmetry.
HandEyeStart settle(CameraMount mount, std::span<const Pose> F, std::span<const Pose> seen,
                    std::span<const Pose> symmetries, std::vector<std::size_t> k) {
  HandEyeStart start = fit(mount, F, turned(seen, symmetries, k));
  for (int round = 0; round < 6; ++round) {
    std::vector<std::size_t> next = k;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const Pose predicted = predicted_board(mount, F[i], start.X, start.Y);
      double least = 1e300;
      for (std::size_t s = 0; s < symmetries.size(); ++s) {
        const double cost = misfit_m(predicted, seen[i] * symmetries[s]);
        if (cost < least - 1e-9) least = cost, next[i] = s;
      }
    }
    if (next == k) break;
    k = next;
    start = fit(mount, F, turned(seen, symmetries, k));
  }
  start.turned.assign(k.begin(), k.end());
  return start;
}

}  // namespace

CameraModel first_lens(const CornerSet& corners, Distortion distortion) {
  std::vector<std::vector<cv::Point3f>> board;
  std::vector<std::vector<cv::Point2f>> image;
  cv::Size size(corners.width, corners.height);
  for (const BoardView& view : corners.views) {
    const Points points = points_of(corners.p_board, view);
    board.emplace_back(points.board.begin(), points.board.end());
    image.emplace_back(points.image.begin(), points.image.end());
    if (corners.width == 0)
      for (const cv::Point2f& p : image.back())
        size = {std::max(size.width, static_cast<int>(p.x) + 2), std::max(size.height, static_cast<int>(p.y) + 2)};
  }
  cv::Mat K, d;
  std::vector<cv::Mat> r, t;
  try {
    const int flags = distortion == Distortion::radtan4 ? cv::CALIB_FIX_K3 : 0;
    cv::calibrateCamera(board, image, size, K, d, r, t, flags);
  } catch (const cv::Exception&) {
    K.release();
  }
  if (K.empty() || !cv::checkRange(K) || !(K.at<double>(0, 0) > 0) || !(K.at<double>(0, 0) < 1e6))
    throw InputError("lens", "the views do not determine the focal length", "add tilted views, or give --camera FILE");
  CameraModel camera{corners.width,
                     corners.height,
                     distortion,
                     {K.at<double>(0, 0), K.at<double>(1, 1), K.at<double>(0, 2), K.at<double>(1, 2)}};
  for (int i = 0; i < 5; ++i) camera.lens[static_cast<std::size_t>(4 + i)] = d.at<double>(i);
  return camera;
}

BoardFit board_pose(const CameraModel& camera, const std::vector<Eigen::Vector3d>& p_board, const BoardView& view) {
  const Points points = points_of(p_board, view);
  const std::vector<cv::Point2d> rays = normalised(camera, points.image);
  std::vector<cv::Mat> r, t;
  try {
    cv::solvePnPGeneric(points.board, rays, cv::Matx33d::eye(), cv::noArray(), r, t, false, cv::SOLVEPNP_IPPE);
    for (std::size_t i = 0; i < r.size(); ++i)
      cv::solvePnPRefineLM(points.board, rays, cv::Matx33d::eye(), cv::noArray(), r[i], t[i]);
  } catch (const cv::Exception&) {
    r.clear();
  }
  BoardFit best;
  best.rms_px = 1e300;
  for (std::size_t i = 0; i < r.size(); ++i) {
    cv::Mat R;
    cv::Rodrigues(r[i], R);
    const Pose T = to_pose(R, t[i]);
    double sum = 0;
    for (const Corner& corner : view.corners) {
      Eigen::Vector2d pixel(1e6, 1e6);
      project<double>(camera.distortion, camera.lens.data(), T * p_board[static_cast<std::size_t>(corner.index)],
                      pixel);
      sum += (pixel - corner.pixel).squaredNorm();
    }
    const double rms = std::sqrt(sum / static_cast<double>(view.corners.size()));
    if (rms < best.rms_px) best = {T, rms};
  }
  if (!(best.rms_px < 1e5))
    throw InputError("view " + view.name, "its corners fit no pose of the board", "drop the view, or check --board");
  return best;
}

Pose predicted_board(CameraMount mount, const Pose& T_base_flange, const Pose& X, const Pose& Y) {
  return X.inverse() * (mount == CameraMount::moving ? T_base_flange.inverse() : T_base_flange) * Y;
}

HandEyeStart start_hand_eye(CameraMount mount, std::span<const RobotPose> poses, std::span<const Pose> T_camera_board,
                            std::span<const Pose> symmetries) {
  std::vector<Pose> F;
  for (const RobotPose& pose : poses) F.push_back(pose.T_base_flange);
  HandEyeStart best = settle(mount, F, T_camera_board, symmetries, std::vector<std::size_t>(F.size(), 0));
  for (std::size_t anchor = 0; symmetries.size() > 1 && anchor < F.size();
       anchor += std::max<std::size_t>(1, F.size() / 4)) {
    HandEyeStart other =
        settle(mount, F, T_camera_board, symmetries, turns_like_robot(mount, F, T_camera_board, symmetries, anchor));
    if (other.misfit_m < 0.7 * best.misfit_m) best = std::move(other);
  }
  const std::vector<std::size_t> k(best.turned.begin(), best.turned.end());
  HandEyeStart few = of_the_best_three(mount, F, turned(T_camera_board, symmetries, k));
  if (few.misfit_m >= 0.7 * best.misfit_m) return best;
  few.turned = best.turned;
  return few;
}

std::vector<BoardTurn> board_turns(const std::vector<Eigen::Vector3d>& p_board, int cols, int rows) {
  std::vector<int> same(p_board.size());
  std::iota(same.begin(), same.end(), 0);
  std::vector<BoardTurn> turns{{0, Pose::Identity(), same}};
  if (cols < 2 || rows < 2 || static_cast<int>(p_board.size()) != cols * rows) return turns;
  const Eigen::Vector3d centre = (p_board.front() + p_board.back()) / 2;
  for (int quarter = 1; quarter < 4; ++quarter) {
    if (quarter % 2 == 1 && cols != rows) continue;
    BoardTurn turn{quarter, Pose::Identity(), same};
    turn.T_board_turned.linear() = rotation_of({0, 0, quarter * 1.5707963267948966});
    turn.T_board_turned.translation() = centre - turn.T_board_turned.linear() * centre;
    for (std::size_t i = 0; i < p_board.size(); ++i) {
      const Eigen::Vector3d p = turn.T_board_turned.inverse() * p_board[i];
      const auto nearest = std::min_element(p_board.begin(), p_board.end(), [&](const auto& a, const auto& b) {
        return (a - p).squaredNorm() < (b - p).squaredNorm();
      });
      turn.order[i] = static_cast<int>(nearest - p_board.begin());
    }
    turns.push_back(turn);
  }
  return turns;
}

}  // namespace foresight
