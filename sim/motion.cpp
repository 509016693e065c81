#include "sim/motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

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

// Eye and what it looks at, world, metres; kHeadPeriod / kKeys apart.
constexpr double kHeadPeriod = 12;
constexpr double kHeadKeys[kKeys][6] = {
    {-0.74, 0.08, 0.48, -0.08, 0.04, 0.03},    // over the mat
    {-0.74, 0.26, 0.48, -0.06, 0.26, 0.04},    //
    {-0.38, 0.51, 0.25, -0.24, 0.53, -0.03},   // close to the paper
    {-0.60, 0.32, 0.40, -0.02, 0.40, 0.05},    // the blocks
    {-0.70, 0.02, 0.50, -0.06, 0.02, 0.05},    //
    {-0.62, -0.18, 0.42, -0.06, -0.16, 0.05},  // mug, bottle and hand
    {-0.72, -0.06, 0.52, -0.12, -0.06, 0.03},  //
    {-0.76, 0.02, 0.48, -0.06, 0.02, 0.03},
};

// A closed cubic spline through values that are 1 / kKeys apart.
struct Spline {
  std::array<double, kKeys> y, d;  // values and slopes per key interval

  double at(double turns) const {
    const double place = (turns - std::floor(turns)) * kKeys;
    const int k = std::min(static_cast<int>(place), kKeys - 1), next = (k + 1) % kKeys;
    const double s = place - k;
    return y[k] +
           s * (d[k] + s * (3 * (y[next] - y[k]) - 2 * d[k] - d[next] + s * (2 * (y[k] - y[next]) + d[k] + d[next])));
  }
};

// One spline per column. Slopes solve d[k-1] + 4 d[k] + d[k+1] = 3 (y[k+1] - y[k-1]), by Gauss and Seidel.
template <std::size_t kColumns>
std::array<Spline, kColumns> closed_splines(const double (&keys)[kKeys][kColumns]) {
  std::array<Spline, kColumns> out{};
  for (std::size_t j = 0; j < kColumns; ++j) {
    auto& [y, d] = out[j];
    for (int k = 0; k < kKeys; ++k) y[k] = keys[k][j];
    for (int round = 0; round < 60; ++round)
      for (int k = 0; k < kKeys; ++k) {
        const int before = (k + kKeys - 1) % kKeys, after = (k + 1) % kKeys;
        d[k] = (3 * (y[after] - y[before]) - d[before] - d[after]) / 4;
      }
  }
  return out;
}

// Through the arm's keys in another order; the first stays.
std::array<Spline, 8> arm_splines(unsigned order) {
  double keys[kKeys][8];
  std::copy(&kArmKeys[0][0], &kArmKeys[0][0] + kKeys * 8, &keys[0][0]);
  std::mt19937 generator(order);
  for (unsigned k = kKeys - 1; k > 1; --k) std::swap(keys[k], keys[1 + generator() % k]);
  return closed_splines(keys);
}

}  // namespace

Pose T_world_camera_at(double t) {
  static const auto splines = closed_splines(kHeadKeys);
  const auto at = [&](std::size_t j) { return splines[j].at(t / kHeadPeriod); };
  const Eigen::Vector3d shake(tremor(t, 0.11), tremor(t, 0.37), tremor(t, 0.71));
  const Eigen::Vector3d eye = Eigen::Vector3d(at(0), at(1), at(2)) + 0.002 * shake;
  const Eigen::Vector3d target =
      Eigen::Vector3d(at(3), at(4), at(5)) + 0.003 * Eigen::Vector3d(tremor(t, 0.53), tremor(t, 0.23), tremor(t, 0.17));

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

ArmPosition arm_position_at(double t, unsigned order) {
  static const auto usual = closed_splines(kArmKeys);
  const auto splines = order == 0 ? usual : arm_splines(order);
  ArmPosition out;
  for (std::size_t j = 0; j < 7; ++j) out.joints[j] = splines[j].at(t / kArmPeriod);
  out.opening = splines[7].at(t / kArmPeriod);
  return out;
}

LabState lab_state_at(const Lab& lab, double t, unsigned order) {
  LabState state = lab.at_rest();
  const auto links = arm_links_at(arm_position_at(t, order));
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
