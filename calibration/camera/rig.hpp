// One camera or a pair, the board they look at, and what they saw, as the solvers want it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calibration/camera/camera_model.hpp"
#include "calibration/result/view_print.hpp"
#include "calibration/target/corner_set.hpp"

namespace foresight {

/// A board that is not flat: a paraboloid of two numbers, the heights in metres that the middle of
/// a column and of a row have above their ends.
///
///   z = x_m * (1 - x^2) + y_m * (1 - y^2)      x, y from -1 to 1 across the board
struct BoardWarp {
  double x_m = 0;
  double y_m = 0;
};

/// Where the board's points lie when it is warped so; `p_board` is flat, metres.
std::vector<Eigen::Vector3d> warped(const std::vector<Eigen::Vector3d>& p_board, const BoardWarp& warp);

/// The factors of BoardWarp's two numbers at each point.
std::vector<Eigen::Vector2d> warp_weights(const std::vector<Eigen::Vector3d>& p_board);

/// Cameras, and the board that they were calibrated with.
struct CameraRig : CalibratedCameras {
  BoardWarp warp;
};

/// What all cameras saw at one instant; empty where a camera saw nothing.
struct RigView {
  std::string name;
  std::array<std::vector<Corner>, 2> corners;

  bool both() const { return !corners[0].empty() && !corners[1].empty(); }
};

struct RigViews {
  int cameras = 1;
  std::array<int, 2> width{};   ///< px, 0: unknown
  std::array<int, 2> height{};  ///< px
  std::vector<Eigen::Vector3d> p_board;
  std::vector<RigView> views;
};

/// Throws InputError: boards of the two cameras differ, a corner that is not finite (naming camera,
/// view and index), a view with fewer than four corners, two views of one name.
RigViews rig_views(const CornerSet& camera);
RigViews rig_views(const StereoCorners& pair);

/// The views at `indices`, in their order.
RigViews subset(const RigViews& all, const std::vector<std::size_t>& indices);

/// Prints of those of `all` whose names are among the views of `some`: of what the cameras saw, before it was mended.
ViewPrints prints_of(const RigViews& all, const RigViews& some);
ViewPrint print_of(const RigView& view);
ViewPrints prints_of(const CornerSet& camera);

/// "left", "right"; "camera" where there is one only.
std::string camera_name(int camera, int cameras);

/// Point of the board frame in coordinates of camera 0 or 1, from the left camera's.
Eigen::Vector3d to_camera(const CalibratedCameras& rig, int camera, const Eigen::Vector3d& p_left);

/// Pixel of a point in camera coordinates, and its derivative after that point where wanted.
std::optional<Eigen::Vector2d> project(const CameraModel& camera, const Eigen::Vector3d& p_camera,
                                       Eigen::Matrix<double, 2, 3>* derivative = nullptr);

/// Unit ray that is seen at `pixel`, by Newton's method; nothing where it does not converge.
std::optional<Eigen::Vector3d> unproject(const CameraModel& camera, const Eigen::Vector2d& pixel);

}  // namespace foresight
