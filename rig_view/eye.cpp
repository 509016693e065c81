#include "rig_view/eye.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace foresight {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFocal = 1.4;  // heights of the picture: 39 degrees from top to bottom
constexpr double kNear = 0.02;  // metres
constexpr double kSteepest = 0.4999 * kPi;

}  // namespace

Eye Eye::from(LookFrom side, const Eigen::AlignedBox3d& what, double proportions) {
  Eye eye;
  eye.target = what.center();
  eye.perspective = side == LookFrom::iso;
  switch (side) {
    case LookFrom::front: break;
    case LookFrom::side: eye.azimuth = -kPi / 2; break;
    case LookFrom::top:
      eye.azimuth = kPi;  // x upwards in the picture, y to the left
      eye.elevation = kSteepest;
      break;
    case LookFrom::iso:
      eye.azimuth = -0.70;
      eye.elevation = 0.45;
      break;
  }
  eye.distance = 1;
  const Pose T_eye_world = eye.T_world_eye().inverse();
  double needed = 0.1;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d p =
        T_eye_world * what.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)) - Eigen::Vector3d(0, 0, 1);
    const double half = std::max(std::abs(p.x()) / proportions, std::abs(p.y()));
    needed = std::max(needed, 2 * kFocal * half * 1.08 - (eye.perspective ? p.z() : 0));
  }
  eye.distance = needed;
  return eye;
}

void Eye::orbit(double right_px, double down_px) {
  azimuth -= 0.008 * right_px;
  elevation = std::clamp(elevation + 0.008 * down_px, -kSteepest, kSteepest);
}

void Eye::shift(double right_px, double down_px, int height_px) {
  target -= T_world_eye().linear() * Eigen::Vector3d(right_px, down_px, 0) * metres_per_pixel(height_px);
}

void Eye::zoom(double steps) {
  distance = std::clamp(distance * std::pow(0.88, steps), 0.05, 200.0);
}

Pose Eye::T_world_eye() const {
  const Eigen::Vector3d out(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                            std::sin(elevation));
  const Eigen::Vector3d right(-std::sin(azimuth), std::cos(azimuth), 0);
  Pose pose = Pose::Identity();
  pose.linear().col(0) = right;
  pose.linear().col(1) = right.cross(out);  // down, as z looks along -out
  pose.linear().col(2) = -out;
  pose.translation() = target + distance * out;
  return pose;
}

double Eye::metres_per_pixel(int height) const {
  return distance / (kFocal * height);
}

Eigen::Matrix4f Eye::clip_from_world(int width, int height) const {
  Eigen::Matrix4d clip = Eigen::Matrix4d::Zero();
  clip(0, 0) = 2 * kFocal * height / width;
  clip(1, 1) = 2 * kFocal;
  if (perspective) {
    clip(2, 3) = kNear;
    clip(3, 2) = 1;
  } else {  // depth from ten distances before the target to ten behind it
    clip(2, 2) = -1.0 / 20;
    clip(2, 3) = distance * 11.0 / 20;
    clip(3, 3) = distance;
  }
  return (clip * T_world_eye().inverse().matrix()).cast<float>();
}

std::optional<Eigen::Vector2d> Eye::pixel(const Eigen::Vector3d& p_world, int width, int height) const {
  const Eigen::Vector3d p = T_world_eye().inverse() * p_world;
  if (perspective && p.z() < kNear) return std::nullopt;
  const double scale = kFocal * height / (perspective ? p.z() : distance);
  return Eigen::Vector2d(0.5 * width + scale * p.x() - 0.5, 0.5 * height + scale * p.y() - 0.5);
}

}  // namespace foresight
