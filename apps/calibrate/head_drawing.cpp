#include "apps/calibrate/head_drawing.hpp"

#include <algorithm>

#include "apps/calibrate/view_pictures.hpp"
#include "calibration/result/frame_drawing.hpp"

namespace foresight {

std::string head_svg(const DrawnHead& head) {
  constexpr std::size_t kMostCameras = 12;
  const PanTiltModel& m = head.model;
  Pose T_world_tilt = m.T_world_pan;
  T_world_tilt.translate(Eigen::Vector3d(m.length_m, 0, 0));
  T_world_tilt.rotate(Eigen::AngleAxisd(m.twist_rad, Eigen::Vector3d::UnitX()));
  Eigen::AlignedBox3d box(m.T_world_pan.translation());
  for (const PanTiltAngles& angles : head.angles) box.extend(camera_pose(m, angles).translation());
  const double size = std::clamp(0.5 * box.diagonal().norm(), 0.03, 0.3);
  FrameDrawing drawing;
  for (const auto& tag : head.tags) drawing.line({tag.begin(), tag.end()}, "k5", true);
  const auto axis = [&](const Pose& T, const char* css) {
    drawing.line({T * Eigen::Vector3d(0, 0, -1.5 * size), T * Eigen::Vector3d(0, 0, 1.5 * size)}, css);
  };
  axis(m.T_world_pan, "az"), axis(T_world_tilt, "k7");
  drawing.frame("pan axis", m.T_world_pan, 0.5 * size);
  drawing.frame("tilt axis", T_world_tilt, 0.5 * size);
  for (const std::size_t i : some_of(head.angles.size(), kMostCameras))
    drawing.camera("", camera_pose(m, head.angles[i]), head.tan_x, head.tan_y, size);
  drawing.frame("camera at zero", camera_pose(m, {}), 0.5 * size);
  return drawing.svg("the head, its axes and its camera");
}

}  // namespace foresight
