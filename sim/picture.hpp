// The camera of the synthetic runs: exact rays through the lens, many per pixel, in linear light.
//
// Shares no code with the OpenGL path, so its pictures are an independent truth for it.
#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <utility>
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
  /// Not finite where the lens sees nothing. Directions in between are taken as bilinear, to 1e-3 px in an
  /// image of usual size.
  const Eigen::Vector2f& corner(int column, int row) const {
    return corners_[static_cast<std::size_t>(row) * (width_ + 1) + column];
  }
  /// The same at the centre of the pixel, exactly.
  const Eigen::Vector2f& centre(int column, int row) const {
    return centres_[static_cast<std::size_t>(row) * width_ + column];
  }

 private:
  int width_, height_;
  float pixel_angle_;
  std::vector<Eigen::Vector2f> corners_, centres_;
};

/// What the camera sees, and what it sees it of.
struct Picture {
  explicit Picture(cv::Size size);

  cv::Mat light;  ///< CV_32FC3, linear RGB; 0 where nothing is
  cv::Mat depth;  ///< CV_32FC1, metres along the optical axis, of the ray through the pixel's centre; 0: nothing
  cv::Mat facet;  ///< CV_32SC1, the facet that this ray meets, numbered as in LightMap; -1: nothing
};

/// Immutable; safe to share between threads. `lab` and `light` must outlive it.
class Renderer {
 public:
  /// kSide^2 rays per pixel, on a regular grid; odd, so that one goes through the pixel's centre.
  static constexpr int kSide = 3;

  /// `poll` is called now and then, from every thread that renders; what it throws stops the work.
  Renderer(const Lab& lab, const LightMap& light, std::function<void()> poll = {})
      : lab_(lab), light_(light), poll_(std::move(poll)) {}

  const Lab& lab() const { return lab_; }
  const LightMap& light() const { return light_; }

  /// The rows [first_row, end_row) of what the camera sees while the parts stand at `T_world_part`,
  /// lit by `irradiance` (LightMap::lit of the same state). One thread.
  void render(const RayTable& rays, const Pose& T_world_camera, const LabState& T_world_part,
              const LightMap::Irradiance& irradiance, int first_row, int end_row, Picture& out) const;

  /// All rows.
  Picture render(const RayTable& rays, const Pose& T_world_camera, const LabState& T_world_part,
                 const LightMap::Irradiance& irradiance) const;

 private:
  const Lab& lab_;
  const LightMap& light_;
  std::function<void()> poll_;
};

}  // namespace foresight::sim
