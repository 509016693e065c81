// An image and where it was taken.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "scene/scene_model.hpp"

namespace foresight {

/// One camera image with the pose of its camera and of everything else at its capture instant.
struct PosedImage {
  cv::Mat pixels;  ///< CV_8UC1, or CV_8UC3 (BGR), of the lens's size; raw, never undistorted
  RobotTime time;  ///< mid-exposure of the centre row
  Pose T_world_camera;
  SceneState scene;  ///< at `time`
  /// TextureOptions::margin_px for this image, where its registration knows better. Range 0 .. 32.
  std::optional<double> margin_px = std::nullopt;
  /// What coding took away from it (coding_loss.hpp); empty where nothing is known to be lost.
  cv::Mat lost = {};
};

/// The images of one stereo head, taken together. The right one may be missing.
struct PosedFrame {
  PosedImage left;
  std::optional<PosedImage> right;
};

/// Margin for an image whose pose is expected to be off by `predicted_px`: `margin_px` is that of exact poses.
double margin_for(double margin_px, double predicted_px);

}  // namespace foresight
