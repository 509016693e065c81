#include "sim/motion.hpp"

#include <algorithm>
#include <array>
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

// Joint positions (rad) and each finger's way (m), kArmPeriod / kKeys apart.
constexpr int kKeys = 8;
constexpr double kArmKeys[kKeys][8] = {
    {-0.64, 0.59, 1.01, 2.12, -1.09, 0.52, 0.91, 0.010},  // drawn back
    {-0.05, 1.00, 0.54, 1.25, -0.60, 0.77, 0.30, 0.026},  // above the mat
    {0.00, 1.22, 0.42, 1.25, -1.09, 0.41, 0.55, 0.030},   // down to it
    {-0.11, 0.98, 0.55, 1.15, -0.72, 0.80, 0.29, 0.012},  // lifted
    {-0.12, 0.90, 0.45, 1.19, -1.17, 0.82, 0.93, 0.014},  // towards the boxes
    {-1.00, 0.47, 1.36, 2.12, -1.01, 1.03, 1.15, 0.022},  // towards bottle and can
    {-0.46, 0.78, 1.15, 2.18, -1.12, 0.55, 1.30, 0.032},  // towards the mug
    {-0.24, 0.88, 0.82, 1.96, -1.20, 0.55, 1.05, 0.020},
};

struct Spline {
  std::array<double, kKeys> y, d;  // values and slopes per key interval
};

// Slopes of the closed cubic spline: d[k-1] + 4 d[k] + d[k+1] = 3 (y[k+1] - y[k-1]), by Gauss and Seidel.
std::array<Spline, 8> arm_splines() {
  std::array<Spline, 8> out{};
  for (std::size_t j = 0; j < 8; ++j) {
    auto& [y, d] = out[j];
    for (int k = 0; k < kKeys; ++k) y[k] = kArmKeys[k][j];
    for (int round = 0; round < 60; ++round)
      for (int k = 0; k < kKeys; ++k) {
        const int before = (k + kKeys - 1) % kKeys, after = (k + 1) % kKeys;
        d[k] = (3 * (y[after] - y[before]) - d[before] - d[after]) / 4;
      }
  }
  return out;
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

ArmPosition arm_position_at(double t) {
  static const auto knots = arm_splines();
  const double place = (t / kArmPeriod - std::floor(t / kArmPeriod)) * kKeys;
  const int k = std::min(static_cast<int>(place), kKeys - 1);
  const double s = place - k;
  ArmPosition out;
  for (std::size_t j = 0; j < 8; ++j) {
    const auto& [y, d] = knots[j];
    const double y0 = y[k], y1 = y[(k + 1) % kKeys], d0 = d[k], d1 = d[(k + 1) % kKeys];
    const double value = y0 + s * (d0 + s * (3 * (y1 - y0) - 2 * d0 - d1 + s * (2 * (y0 - y1) + d0 + d1)));
    (j < 7 ? out.joints[j] : out.opening) = value;
  }
  return out;
}

LabState lab_state_at(const Lab& lab, double t) {
  LabState state = lab.at_rest();
  const auto links = arm_links_at(arm_position_at(t));
  for (std::size_t i = 1; i < links.size(); ++i) state[static_cast<std::size_t>(lab.arm) + i] = links[i];
  return state;
}

Pose T_left_right() {
  Pose pose = Pose::Identity();
  pose.translate(Eigen::Vector3d(0.065, 0.0004, -0.0003));
  pose.rotate(Eigen::AngleAxisd(-0.012, Eigen::Vector3d::UnitY()));
  return pose;
}

}  // namespace foresight::sim
