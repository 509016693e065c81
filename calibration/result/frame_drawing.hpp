// Frames in space as inline SVG, seen from above and aside: x red, y green, z blue, as everywhere.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "scene/scene_model.hpp"

namespace foresight {

/// Everything in one frame with z up, metres. What is added later is drawn over what came before.
class FrameDrawing {
 public:
  /// Three axes of `size` metres and a name beside them; no name: thin axes.
  void frame(const std::string& name, const Pose& T_world_frame, double size);
  /// A camera's image corners at `depth` metres, joined with its centre. `tan_x`, `tan_y`: half its width and height
  /// over its focal lengths.
  void camera(const std::string& name, const Pose& T_world_camera, double tan_x, double tan_y, double depth);
  /// `css_class`: of page.css, k0 to k7.
  void line(const std::vector<Eigen::Vector3d>& points, const std::string& css_class, bool closed = false);
  void dot(const Eigen::Vector3d& point, const std::string& css_class);

  /// With a grid under it that is as wide as all of it, its cells in `label` for those who cannot see it.
  std::string svg(const std::string& label) const;

 private:
  struct Line {
    std::vector<Eigen::Vector3d> points;
    std::string css_class;
    double width = 1.5;
    bool closed = false;
  };
  struct Word {
    Eigen::Vector3d at;
    std::string text;
  };
  std::vector<Line> lines_;
  std::vector<Word> words_;
  std::vector<std::pair<Eigen::Vector3d, std::string>> dots_;
};

}  // namespace foresight
