// A small textured world, drawn by ray casting: a tilted floor and a board before it.
#pragma once

#include <cmath>

#include "calibration/registration/rendered_view.hpp"
#include "common/lens.hpp"

namespace foresight {

struct TwoPlanes {
  double phase = 0;  ///< another value, another picture

  static Lens lens() {
    Lens::Parameters p;
    p.width = 320, p.height = 240;
    p.fx = p.fy = 260, p.cx = 159.5, p.cy = 119.5;
    p.d = {-0.1, 0.02, 0.0005, -0.0003, 0};
    return Lens(p);
  }

  /// Grey at a point of a plane, smooth on the scale of some pixels.
  double paint(double x, double y) const {
    const double a = std::sin(41 * x + 7 * y + phase) + std::sin(-13 * x + 37 * y + 2 * phase) +
                     std::sin(71 * x - 59 * y + 3 * phase) + std::sin(90 * y + 5 * phase);
    return 128 + 26 * a;
  }

  RenderedView view(const Pose& T_world_camera) const {
    const Lens lens = TwoPlanes::lens();
    RenderedView out{T_world_camera, cv::Mat(lens.height(), lens.width(), CV_8UC4, cv::Scalar::all(0)),
                     cv::Mat(lens.height(), lens.width(), CV_32FC1, cv::Scalar(0))};
    for (int v = 0; v < lens.height(); ++v)
      for (int u = 0; u < lens.width(); ++u) {
        const auto ray = lens.unproject({u, v});
        if (!ray) continue;
        const Eigen::Vector3d o = T_world_camera.translation(), d = T_world_camera.linear() * *ray;
        const double t_board = (0.6 - o.z()) / d.z();
        const Eigen::Vector3d at = o + t_board * d;
        const bool on_board = std::abs(at.x()) < 0.12 && std::abs(at.y()) < 0.1;
        // The floor: z = 1 + 0.3 y.
        const double t = on_board ? t_board : (1 + 0.3 * o.y() - o.z()) / (d.z() - 0.3 * d.y());
        const Eigen::Vector3d p = o + t * d;
        const auto grey = static_cast<std::uint8_t>(std::clamp(paint(p.x(), p.y() + (on_board ? 5 : 0)), 0.0, 255.0));
        out.colour.at<cv::Vec4b>(v, u) = {grey, grey, grey, 255};
        out.range.at<float>(v, u) = static_cast<float>(t);
      }
    return out;
  }

  cv::Mat image(const Pose& T_world_camera) const {
    cv::Mat grey;
    cv::extractChannel(view(T_world_camera).colour, grey, 0);
    return grey;
  }
};

}  // namespace foresight
