// Boards drawn into images, with the truth.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "calibration/target/board.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

struct DrawnView {
  cv::Mat grey;
  std::vector<Eigen::Vector2d> pixels;  ///< of every point of the board
  double coverage = 0;                  ///< of the image, by the points
};

enum class TagRows { from_above, from_below };

/// The board in the middle of the image on a grey wall, turned in the image by `roll_deg`
/// (clockwise), its right side moved away from the camera by `tilt_deg`; 4x4 samples a pixel.
DrawnView draw_board(const Board& board, int width, int height, double roll_deg, double tilt_deg,
                     TagRows rows = TagRows::from_above);

/// The same from any side, by a pinhole camera with a focal length of `width` px, its centre in the image's middle.
DrawnView draw_board_at(const Board& board, int width, int height, const Pose& T_camera_board);

}  // namespace foresight
