// Whether a camera saw a surface point, in what colour and how sharply: one point at a time.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "common/lens.hpp"
#include "tests/texture_gpu/reference/edges.hpp"

namespace foresight::reference {

/// A camera at one instant.
struct Camera {
  Lens lens;
  gl::Faces faces;
  std::vector<Pose> T_camera_node;
  std::vector<FacePicture> depth;  ///< of each face
  std::vector<std::vector<std::uint8_t>>
      uncertain;  ///< of each face: 0 no, 1 an outermost pixel of a near side, 2 the far side
  cv::Mat image;  ///< CV_8UC3, BGR
};

/// Those of the four depths around the point's place on its face that show model bracket it within
/// the tolerance, all four are certain, and its pixel lies in the image with half a pixel to spare. Borderline where
/// the precision of float or of texture coordinates (1/256 px) decides. `pixel`: in the image.
Answer is_seen(const Camera& camera, const Eigen::Vector3d& p, double depth_tolerance, Eigen::Vector2d& pixel);

/// Catmull-Rom over the 4 x 4 pixels around; RGB, 0 .. 1, clamped.
Eigen::Vector3d catmull_rom(const cv::Mat& bgr, const Eigen::Vector2d& pixel);

/// Mean of the picture over the parallelogram pixel + axes * [-1/2, 1/2]^2, by many samples; RGB, 0 .. 1.
Eigen::Vector3d mean_over(const cv::Mat& bgr, const Eigen::Vector2d& pixel, const Eigen::Matrix2d& axes);

/// Pixels per texel along its two axes at p: derivative of the projection (columns u, v). Of
/// perspective lenses without their distortion, of equidistant ones without their polynomial: the
/// resolution serves to compare views, and the lens is the same in all of them.
Eigen::Matrix2d footprint(const Camera& camera, const Eigen::Vector3d& p, const Eigen::Vector3d& eu,
                          const Eigen::Vector3d& ev);

/// 2 .. 31: log2 of the pixels per texel from -8 to 0.
double quality_code(double pixels_per_texel);

/// The newest wins unless it has less than `worse` of the old resolution; then the old colour ages
/// by one step where it is its turn. Codes of 0 .. 31; `fresh` code 0: not seen now.
struct Fused {
  bool takes_fresh = false;
  double code = 0;
};
Fused fuse(double old_code, double fresh_code, double worse, bool its_turn);

}  // namespace foresight::reference
