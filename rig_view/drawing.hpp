// Shapes of a technical picture, as triangles, lines and words in the world: what is drawn besides meshes.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "scene/scene_model.hpp"

namespace foresight {

/// Red, green, blue, opacity; 0 .. 1. Not aligned: it lies in vertices.
using Colour = Eigen::Matrix<float, 4, 1, Eigen::DontAlign>;

inline Colour with_opacity(Colour colour, float opacity) {
  colour[3] = opacity;
  return colour;
}

/// One of these shapes after the other; world, metres. Adding is all that it does.
struct Drawing {
  struct Corner {
    Eigen::Vector3f p;
    Colour colour;
  };
  struct Line {
    Eigen::Vector3f from, to;
    Colour colour;
    float width_px = 1.5f;
  };
  struct Word {
    Eigen::Vector3d at;
    std::string text;
    Colour colour;
  };
  std::vector<Corner> glass;  ///< three to a triangle; seen through
  std::vector<Line> lines;    ///< also seen, faintly, through what stands before them
  std::vector<Word> words;

  void line(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Colour& colour, float width_px = 1.5f);
  void triangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c, const Colour& colour);
  void word(const Eigen::Vector3d& at, std::string text, const Colour& colour);

  /// The box's edges; its sides, too, where `sides` has any opacity.
  void box(const Eigen::AlignedBox3d& box, const Colour& edges, const Colour& sides, float width_px = 1.5f);
  /// All within `radius` of the segment.
  void capsule(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius, const Colour& colour);
  /// From `from` to `to` rad about `axis` (unit), counted from `zero` (unit, upright on the axis).
  void arc(const Eigen::Vector3d& centre, const Eigen::Vector3d& axis, const Eigen::Vector3d& zero, double radius,
           double from, double to, const Colour& colour, float width_px);
  /// Axes x red, y green, z blue.
  void axes(const Pose& T_world_frame, double length, float width_px = 2);
  /// Squares of `pitch` in the plane z = 0 of the frame, `steps` of them to either side.
  void grid(const Pose& T_world_frame, double pitch, int steps, const Colour& colour);
};

}  // namespace foresight
