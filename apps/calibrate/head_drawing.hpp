// A two-axis head in space, for the reports of `calibrate pan-tilt`.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "calibration/robot/pan_tilt.hpp"

namespace foresight {

struct DrawnHead {
  PanTiltModel model;
  std::vector<PanTiltAngles> angles;                      ///< of the views; some of them are drawn
  double tan_x = 0.5, tan_y = 0.4;                        ///< half the camera's width and height over its focal lengths
  std::vector<std::array<Eigen::Vector3d, 4>> tags = {};  ///< corners, world
};

/// Inline SVG: both axes, the camera at some of the angles, the tags.
std::string head_svg(const DrawnHead& head);

}  // namespace foresight
