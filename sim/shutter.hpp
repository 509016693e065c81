// How long and when each row of the sensor collects light.
#pragma once

#include <functional>

#include "sim/picture.hpp"

namespace foresight::sim {

/// Motion of the camera and of the lab; `t` in seconds. Safe to call from any thread.
struct LabMotion {
  std::function<Pose(double t)> T_world_camera;
  std::function<LabState(double t)> T_world_part;
};

struct Shutter {
  double exposure_s = 0;  ///< each row collects light for this long
  double readout_s = 0;   ///< from the first to the last row, which are exposed one after another; 0: all at once

  /// Middle of the exposure of `row` in an image of `rows` rows whose centre row's is at `t`.
  double row_time(double t, int row, int rows) const {
    return t + readout_s * (row - (rows - 1) / 2.0) / (rows > 1 ? rows - 1 : 1);
  }
};

/// The image at `t`: rows at their own times, each averaged over the exposure. Depth and facets
/// are those at each row's mid-exposure. The light is computed at the first and the last instant
/// and in between interpolated. One thread.
Picture expose(const Renderer& renderer, const RayTable& rays, const LabMotion& motion, const Shutter& shutter,
               double t);

}  // namespace foresight::sim
