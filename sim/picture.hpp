// The camera of the sample run: exact rays through the lens, many per pixel, in linear light.
//
// Shares no code with the OpenGL path, so its pictures are an independent truth for it.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "common/lens.hpp"
#include "sim/lab.hpp"
#include "sim/light_map.hpp"

namespace foresight::sim {

/// Where each pixel of a lens looks. Immutable; safe to share between threads.
class RayTable {
 public:
  explicit RayTable(const Lens& lens);

  int width() const { return width_; }
  int height() const { return height_; }
  float pixel_angle() const { return pixel_angle_; }  ///< radians per pixel on the axis

  /// (x / z, y / z) at the top-left corner of pixel (column, row), column <= width, row <= height.
  /// Within a pixel, directions are bilinear to better than 1e-3 px. Not finite where the lens sees nothing.
  const Eigen::Vector2f& corner(int column, int row) const {
    return corners_[static_cast<std::size_t>(row) * (width_ + 1) + column];
  }

 private:
  int width_, height_;
  float pixel_angle_;
  std::vector<Eigen::Vector2f> corners_;
};

/// Immutable; safe to share between threads. `lab` and `light` must outlive it.
class Renderer {
 public:
  static constexpr int kSide = 3;  ///< kSide^2 rays per pixel, on a regular grid

  Renderer(const Lab& lab, const LightMap& light) : lab_(lab), light_(light) {}

  /// The picture (CV_8UC3, BGR, sRGB) with the plate at `T_world_plate`, lit by `irradiance`
  /// (LightMap::with_plate_at the same pose). One thread. Black where the lens sees nothing.
  cv::Mat render(const RayTable& rays, const Pose& T_world_camera, const Pose& T_world_plate,
                 const LightMap::Irradiance& irradiance) const;

 private:
  const Lab& lab_;
  const LightMap& light_;
};

}  // namespace foresight::sim
