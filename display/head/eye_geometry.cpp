#include "display/head/eye_geometry.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "input/room_axes.hpp"

namespace foresight::head {
namespace {

constexpr double kRoom = 100;                    // m
constexpr double kWidest = 89 * EIGEN_PI / 180;  // rad from straight ahead
constexpr double kWidestGuarded = 85 * EIGEN_PI / 180;
constexpr double kNarrowest = EIGEN_PI / 180;  // rad from side to side
constexpr double kStraightUp = 0.1;            // sine of the angle from the vertical: no heading below

}  // namespace

std::optional<Pose> checked_pose(const Eigen::Vector3d& p_room, const Eigen::Quaterniond& q_room) {
  const double length = q_room.norm();
  if (!p_room.allFinite() || p_room.norm() > kRoom || !(std::abs(length - 1) < 0.01)) return std::nullopt;
  Pose T_room = Pose::Identity();
  T_room.translation() = p_room;
  T_room.linear() = q_room.normalized().toRotationMatrix();
  return from_room_axes(T_room);
}

std::optional<EyeFov> checked_fov(const EyeFov& fov) {
  const std::array sides{fov.left, fov.right, fov.up, fov.down};
  if (!std::ranges::all_of(sides, [](double angle) { return std::abs(angle) <= kWidest; })) return std::nullopt;
  if (fov.right - fov.left < kNarrowest || fov.up - fov.down < kNarrowest) return std::nullopt;
  return fov;
}

Lens eye_lens(const EyeFov& fov, int width, int height) {
  const double left = std::tan(fov.left), top = -std::tan(fov.up);  // image plane at z = 1, downwards
  Lens::Parameters p;
  p.width = width;
  p.height = height;
  p.fx = width / (std::tan(fov.right) - left);
  p.fy = height / (-std::tan(fov.down) - top);
  p.cx = -0.5 - p.fx * left;
  p.cy = -0.5 - p.fy * top;
  return Lens(p);
}

EyeFov fov_of(const Lens& lens) {
  constexpr int kSteps = 64;
  Eigen::AlignedBox2d seen;  // tangents; x to the right, y down
  for (int i = 0; i <= kSteps; ++i)
    for (int j = 0; j <= kSteps; ++j) {
      const auto ray = lens.unproject({i * lens.width() / static_cast<double>(kSteps) - 0.5,
                                       j * lens.height() / static_cast<double>(kSteps) - 0.5});
      if (ray && ray->z() > std::cos(kWidestGuarded)) seen.extend((ray->head<2>() / ray->z()).eval());
    }
  if (seen.isEmpty()) throw std::invalid_argument("a lens that sees nothing ahead");
  return {std::atan(seen.min().x()), std::atan(seen.max().x()), -std::atan(seen.min().y()), -std::atan(seen.max().y())};
}

EyeFov widened(const EyeFov& fov, double guard) {
  return {std::max(fov.left - guard, std::min(fov.left, -kWidestGuarded)),
          std::min(fov.right + guard, std::max(fov.right, kWidestGuarded)),
          std::min(fov.up + guard, std::max(fov.up, kWidestGuarded)),
          std::max(fov.down - guard, std::min(fov.down, -kWidestGuarded))};
}

bool alike(const Lens& a, const Lens& b) {
  const auto &p = a.parameters(), &q = b.parameters();
  return p.model == q.model && p.d == q.d && p.width == q.width && p.height == q.height &&
         std::abs(p.fx - q.fx) < 1e-3 * p.fx && std::abs(p.fy - q.fy) < 1e-3 * p.fy && std::abs(p.cx - q.cx) < 0.05 &&
         std::abs(p.cy - q.cy) < 0.05;
}

bool alike(const EyeFov& a, const EyeFov& b, double tolerance) {
  return std::abs(a.left - b.left) <= tolerance && std::abs(a.right - b.right) <= tolerance &&
         std::abs(a.up - b.up) <= tolerance && std::abs(a.down - b.down) <= tolerance;
}

Pose T_body_camera() {
  Pose out = Pose::Identity();
  out.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return out;
}

Pose levelled(const Pose& T_space_body) {
  const Eigen::Matrix3d R = T_space_body.linear();
  Eigen::Vector3d forward = R.col(0);
  if (forward.head<2>().norm() < kStraightUp) forward = R(2, 0) < 0 ? 1 * R.col(2) : -1 * R.col(2);
  Pose out = T_space_body;
  out.linear() = Eigen::AngleAxisd(std::atan2(forward.y(), forward.x()), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return out;
}

Pose T_world_space_for(const Pose& T_world_camera, const Pose& T_space_head) {
  return levelled(T_world_camera * T_body_camera().inverse()) * levelled(T_space_head).inverse();
}

}  // namespace foresight::head
