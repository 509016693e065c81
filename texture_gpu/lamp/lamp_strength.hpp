// How much light a lamp gives beside all other light, by how dark its shadows are.
#pragma once

#include "texture_gpu/lamp/moving_shadows.hpp"
#include "texture_gpu/lamp/still_shadows.hpp"

namespace foresight {

/// Of a lamp at some place, as Lamp::strength: red, green, blue; square metres.
struct LampStrength {
  Eigen::Vector3d moving = Eigen::Vector3d::Zero();  ///< by the shadows of what moves
  Eigen::Vector3d still = Eigen::Vector3d::Zero();   ///< by those in single images
  std::size_t shadows = 0;                           ///< observations that the first is drawn from

  /// Enough of them.
  bool is_told_by_what_moves() const;
  /// Something should have thrown shadows, and has not as it would where the lamp has this strength.
  bool is_gone(const Eigen::Vector3d& usual) const;
};

/// For each channel the one with the least absolute error. Metres, world.
LampStrength lamp_strength(const MovingShadows& moving, const StillShadows& still, const Eigen::Vector3d& lamp,
                           double radius);

}  // namespace foresight
