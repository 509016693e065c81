// How a lens moves the pixel of a point that moves.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/lens.hpp"

namespace foresight {

/// d pixel / d p_camera, px per metre, by central differences of 1e-4 of the distance; nothing where
/// the lens does not see all of them. `p_camera`: metres, not the origin.
std::optional<Eigen::Matrix<double, 2, 3>> projection_slope(const Lens& lens, const Eigen::Vector3d& p_camera);

}  // namespace foresight
