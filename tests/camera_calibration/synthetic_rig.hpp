// A random rig whose truth is known, and what it sees of a board.
#pragma once

#include <random>

#include "calibration/camera/rig.hpp"
#include "calibration/target/board.hpp"

namespace foresight::test {

struct SyntheticOptions {
  int views = 15;
  int cameras = 2;
  double noise_px = 0.2;
  double most_tilt = 0.6;                          ///< rad
  bool turn = true;                                ///< rotates the board about its normal
  Eigen::Vector3d lean = Eigen::Vector3d::Zero();  ///< rotation vector, common to all boards, rad
  double one_axis = 1;                             ///< share of most_tilt about the second axis
  double nearest_m = 0;                            ///< of the boards; 0: 0.35 (fish-eye: 0.2)
  double depth_m = -1;                             ///< from the nearest to the farthest; -1: 0.4 (fish-eye: 0.2)
  double spread = 1;                               ///< of the boards over the image; 0: all in its middle
  Distortion distortion = Distortion::radtan4;
};

struct SyntheticRig {
  CameraRig rig;
  std::vector<Pose> T_left_board;
  RigViews views;
};

inline Pose pose_of(const Eigen::Vector3d& turn, const Eigen::Vector3d& at) {
  Pose T = Pose::Identity();
  if (turn.norm() > 0) T.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  T.translation() = at;
  return T;
}

inline CameraModel random_camera(std::mt19937& random, Distortion distortion) {
  std::uniform_real_distribution<double> u(-1, 1);
  CameraModel camera{640, 480, distortion, {}};
  const double f = distortion == Distortion::equidistant ? 260 : 560 + 40 * u(random);
  camera.lens = {f, f * (1 + 0.002 * u(random)), 319.5 + 12 * u(random), 239.5 + 12 * u(random)};
  if (distortion == Distortion::equidistant)
    camera.lens[4] = 0.02 * u(random), camera.lens[5] = 0.005 * u(random);
  else
    camera.lens[4] = -0.2 + 0.08 * u(random), camera.lens[5] = 0.08 + 0.03 * u(random),
    camera.lens[6] = 0.001 * u(random), camera.lens[7] = 0.001 * u(random);
  return camera;
}

/// Views that all cameras see whole.
inline SyntheticRig synthetic_rig(unsigned seed, const SyntheticOptions& options) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  std::normal_distribution<double> noise(0, options.noise_px);
  SyntheticRig s;
  for (int c = 0; c < options.cameras; ++c) s.rig.cameras.push_back(random_camera(random, options.distortion));
  if (options.cameras == 2)
    s.rig.T_left_right = pose_of({0.02 * u(random), 0.03 * u(random), 0.02 * u(random)},
                                 {0.12 + 0.02 * u(random), 0.005 * u(random), 0.005 * u(random)});
  s.views.cameras = options.cameras;
  s.views.width = {640, options.cameras == 2 ? 640 : 0};
  s.views.height = {480, options.cameras == 2 ? 480 : 0};
  s.views.p_board = board_points(parse_board("chessboard:9x6:0.03"));
  const Eigen::Vector3d middle(0.12, 0.075, 0);
  const bool fish_eye = options.distortion == Distortion::equidistant;
  const double nearest = options.nearest_m > 0 ? options.nearest_m : fish_eye ? 0.2 : 0.35;
  const double depth = options.depth_m >= 0 ? options.depth_m : fish_eye ? 0.2 : 0.4;
  while (static_cast<int>(s.views.views.size()) < options.views) {
    const double t = options.most_tilt;
    const Eigen::Vector3d turn(t * u(random), options.one_axis * t * u(random), options.turn ? 0.5 * u(random) : 0);
    const double z = nearest + 0.5 * depth * (1 + u(random));
    const Pose T = pose_of({0, 0, 0}, {0.6 * options.spread * z * u(random), 0.4 * options.spread * z * u(random), z}) *
                   pose_of(options.lean, {0, 0, 0}) * pose_of(turn, {0, 0, 0});
    const Pose T_left_board = T * pose_of({0, 0, 0}, -middle);
    RigView view;
    view.name = "view" + std::to_string(s.views.views.size());
    bool seen = true;
    for (int c = 0; c < options.cameras && seen; ++c)
      for (std::size_t i = 0; i < s.views.p_board.size() && seen; ++i) {
        const Eigen::Vector3d p = to_camera(s.rig, c, T_left_board * s.views.p_board[i]);
        const auto pixel = project(s.rig.cameras[std::size_t(c)], p);
        seen = pixel && pixel->x() > 2 && pixel->y() > 2 && pixel->x() < 637 && pixel->y() < 477;
        if (seen)
          view.corners[std::size_t(c)].push_back(
              {static_cast<int>(i), *pixel + Eigen::Vector2d(noise(random), noise(random)), 1});
      }
    if (!seen) continue;
    s.views.views.push_back(view);
    s.T_left_board.push_back(T_left_board);
  }
  return s;
}

}  // namespace foresight::test
