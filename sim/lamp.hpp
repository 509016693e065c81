// The lab's light: a square lamp, and daylight from all around.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace foresight::sim::lamp {

inline constexpr int kPoints = 64;        ///< the lamp is this many points: one bit each in a 64-bit word
inline constexpr float kRadius = 0.285f;  ///< of the sphere around all of them, metres

const Eigen::Vector3f& centre();                       ///< world
const std::array<Eigen::Vector3f, kPoints>& points();  ///< world

struct Axes {
  Eigen::Vector3f normal, right, up;  ///< world, unit; light leaves along `normal`
};
const Axes& axes();
float size();  ///< of each side, metres

/// Irradiance (linear RGB) at `p` with normal `n` from the lamp points in `seen`.
Eigen::Vector3f irradiance(const Eigen::Vector3f& p, const Eigen::Vector3f& n, std::uint64_t seen);

/// Strength in 0 .. 1 of the lamp's mirror image at `p` for a viewer in `to_eye` (world, unit).
float mirrored(const Eigen::Vector3f& p, const Eigen::Vector3f& n, const Eigen::Vector3f& to_eye);

/// Radiance of the daylight from `direction` (world, unit).
Eigen::Vector3f daylight(const Eigen::Vector3f& direction);

}  // namespace foresight::sim::lamp
