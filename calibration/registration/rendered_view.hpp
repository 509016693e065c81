// What a program that can draw the textured model hands to the registration.
#pragma once

#include <opencv2/core.hpp>

#include "scene/scene_model.hpp"

namespace foresight {

/// The model with the textures that earlier images left on it, drawn through the camera's own lens.
struct RenderedView {
  Pose T_world_camera = Pose::Identity();  ///< drawn from here
  /// CV_8UC4 (BGRA) of the lens's size. Alpha view_alpha::kFromImage: colour that an image saw; anything else is no
  /// evidence: filled hole, model without colour, nothing.
  cv::Mat colour;
  /// CV_32FC1: distance of the surface from the camera's centre along the pixel's ray, metres; 0:
  /// nothing there.
  cv::Mat range;
};

}  // namespace foresight
