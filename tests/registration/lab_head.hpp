// The mock lab's stereo head as the registration knows it.
#pragma once

#include "calibration/registration/registration.hpp"
#include "sim/pan_tilt_head.hpp"
#include "sim/tag_room.hpp"

namespace foresight {

inline HeadModel lab_head() {
  HeadModel head;
  head.T_world_pan = sim::T_world_head_foot();
  head.T_pan_tilt.translate(Eigen::Vector3d(0, 0, 0.08));
  // z of this frame is y of the foot.
  head.T_pan_tilt.rotate(Eigen::AngleAxisd(-std::acos(-1.0) / 2, Eigen::Vector3d::UnitX()));
  const Pose T_world_tilt = T_world_camera(head, {});
  head.T_tilt_camera = T_world_tilt.inverse() * sim::T_world_head_left({});
  return head;
}

inline Lens lab_lens() {
  Lens::Parameters p;
  p.width = 640, p.height = 480;
  p.fx = 520, p.fy = 521, p.cx = 318, p.cy = 243;
  p.d = {-0.12, 0.03, 0.0004, -0.0006, 0};
  return Lens(p);
}

inline const cv::Mat& lab_rays() {
  static const cv::Mat rays = sim::TagRoom::corner_rays(lab_lens());
  return rays;
}

inline StereoLenses lab_lenses() {
  return {lab_lens(), lab_lens(), sim::T_head_left_right()};
}

}  // namespace foresight
