#include "sim/motion.hpp"

#include <cmath>
#include <numbers>

namespace foresight::sim {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

double wave(double t, double period, double phase) {
  return std::sin(kTurn * (t / period + phase));
}

// Tremor of a hand: three incommensurate waves.
double tremor(double t, double phase) {
  return wave(t, 0.93, phase) + 0.5 * wave(t, 0.43, 2.3 * phase) + 0.25 * wave(t, 0.271, 3.1 * phase);
}

}  // namespace

Pose T_world_camera_at(double t) {
  const double azimuth = 0.40 * wave(t, 7.0, -0.21), elevation = 0.42 + 0.06 * wave(t, 5.3, 0.1);
  const double distance = 1.14 + 0.07 * wave(t, 6.1, 0.3);
  const Eigen::Vector3d shake(tremor(t, 0.11), tremor(t, 0.37), tremor(t, 0.71));
  const Eigen::Vector3d eye =
      Eigen::Vector3d(0.02 - distance * std::cos(elevation) * std::cos(azimuth),
                      distance * std::cos(elevation) * std::sin(azimuth), 0.06 + distance * std::sin(elevation)) +
      0.003 * shake;
  const Eigen::Vector3d target(0.06 + 0.004 * tremor(t, 0.53), 0.03 * wave(t, 4.1, 0.6),
                               0.075 + 0.004 * tremor(t, 0.17));

  Pose pose = Pose::Identity();
  const Eigen::Vector3d forward = (target - eye).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  pose.linear() << right, forward.cross(right), forward;
  pose.linear() =
      pose.linear() * Eigen::AngleAxisd(0.02 * wave(t, 3.7, 0.2) + 0.003 * tremor(t, 0.29), Eigen::Vector3d::UnitZ())
                          .toRotationMatrix();
  pose.translation() = eye;
  return pose;
}

Pose T_world_plate_at(double t) {
  Pose pose = Pose::Identity();
  pose.translate(Eigen::Vector3d(-0.205 + 0.035 * wave(t, 2.9, 0.15), 0.02 + 0.15 * wave(t, 3.6, -0.2), 0.0025));
  pose.rotate(Eigen::AngleAxisd(0.55 * wave(t, 4.7, 0.05), Eigen::Vector3d::UnitZ()));
  return pose;
}

Pose T_left_right() {
  Pose pose = Pose::Identity();
  pose.translate(Eigen::Vector3d(0.065, 0.0004, -0.0003));
  pose.rotate(Eigen::AngleAxisd(-0.012, Eigen::Vector3d::UnitY()));
  return pose;
}

}  // namespace foresight::sim
