// The main lamp of a scene, as far as its shadows tell of it.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace foresight {

/// A round lamp that faces all that it lights. Its light falls on top of that which comes from everywhere else:
///
///     light of both : light without the lamp  =  1 + strength (n . l) / d^2 : 1
///
/// d the distance of the surface, n its normal, l the direction to the lamp.
struct Lamp {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< of its centre, world, metres
  double radius = 0;                                   ///< metres; makes shadows soft
  Eigen::Vector3d strength = Eigen::Vector3d::Zero();  ///< red, green, blue; square metres

  bool operator==(const Lamp&) const = default;
};

/// (n . l) / d^2 of a surface with the normal `n` and the lamp at `to_lamp` from it, metres; negative: it faces away.
inline double facing(const Eigen::Vector3d& n, const Eigen::Vector3d& to_lamp) {
  return n.dot(to_lamp) / std::pow(to_lamp.norm(), 3);
}

/// Pixel values go with the light to the power of 1 / kResponse, as gains of the exposure do (exposure.hpp).
inline constexpr double kResponse = 2.2;

/// Factor on pixel values where `hidden` (0 .. 1) of the lamp is hidden that would else give `share` times the light of
/// all else.
inline double shadow_factor(double share, double hidden) {
  return std::pow((1 + share * (1 - std::clamp(hidden, 0.0, 1.0))) / (1 + share), 1 / kResponse);
}

}  // namespace foresight
