// Flat prints in the mock lab: tags on wall and table, a calibration board that somebody holds.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "scene/scene_model.hpp"

namespace foresight::sim {

/// A sheet without thickness, printed on its front; its back is not drawn. It throws no shadow and receives none.
///
/// What the camera's response (sRGB) does to black tags on white it does here too: their corners are found 0.3 px
/// nearer to the tag's middle, and up to 0.8 px where the paper is overexposed. Corners of a chessboard, centres of
/// circles and middles of tags are not moved.
struct Print {
  std::string name;
  /// CV_8UC1, the whole paper from its upper left corner; 0 is ink, 255 bare paper, linear in between (the share of
  /// paper that shows). Edges are as sharp as its pixels: give an edge that matters 10 px of picture per image px.
  cv::Mat picture;
  double width_m = 0, height_m = 0;  ///< of the paper, > 0
  /// Print frame: origin in the paper's middle, x right and y down in print, z into the paper. It may lie in the very
  /// surface that it is stuck to (the mat's is z = 0.002): it is drawn as if a little nearer than that.
  Pose T_world_print = Pose::Identity();
};

/// A print that moves by itself, or with a part of the lab.
struct MovingPrint {
  Print print;                            ///< its own pose is not used
  std::function<Pose(double t)> T_print;  ///< T_world_print or T_part_print `t` seconds after the start; any thread
  std::string part;                       ///< of the lab, that carries it ("arm_link_7"); empty: none
};

/// Corners of black borders, world: lower left, lower right, upper right, upper left in print.
using TagCorners = std::map<int, std::array<Eigen::Vector3d, 4>>;

/// Tags of the family tag36h11, each on paper with one bit of white around it. Throws InputError naming the tag: an id
/// that does not exist, corners that are not a square's (1 % of its side).
std::vector<Print> tag_prints(const TagCorners& corners);

/// Side of the paper of such a tag over that of its black border.
inline constexpr double kTagPaper = 10.0 / 8;

/// CV_8UC1, 10 x 10, one pixel a bit, the white border included. Throws InputError: no such tag.
cv::Mat tag_bits(int id);

/// Throws InputError naming the print: no picture, or one that is not CV_8UC1; a size that is not above 0.
void check(const Print& print);

}  // namespace foresight::sim
