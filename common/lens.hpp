// Lens models: from a point in front of the camera to a pixel, and back.
//
//   camera (optical) frame: x right, y down, z forward, metres
//   pixel (0, 0) is the centre of the top-left pixel; the image spans [-0.5, width - 0.5]
//
// Sources: OpenCV 4.6 calib3d documentation (plumb_bob, rational_polynomial) and its fisheye
// module (equidistant, after Kannala and Brandt 2006); coefficient order and names are those of
// ROS sensor_msgs/CameraInfo.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>

namespace foresight {

enum class LensModel {
  plumb_bob,            ///< d = k1 k2 p1 p2 k3; radial polynomial and tangential terms
  rational_polynomial,  ///< d = k1 k2 p1 p2 k3 k4 k5 k6
  equidistant,          ///< d = k1 k2 k3 k4; polynomial in the angle from the optical axis
};

/// ROS name of the model, as in a camera_info file.
std::string to_string(LensModel model);

/// A calibrated camera. Immutable after construction; safe to share between threads.
class Lens {
 public:
  struct Parameters {
    LensModel model = LensModel::plumb_bob;
    int width = 0;              ///< px
    int height = 0;             ///< px
    double fx = 0;              ///< focal length in px
    double fy = 0;              ///< focal length in px
    double cx = 0;              ///< principal point in px, pixel centres at integers
    double cy = 0;              ///< principal point in px
    std::array<double, 8> d{};  ///< coefficients in the order of `model`; unused ones are zero
  };

  Lens() = default;

  /// Throws std::invalid_argument naming the field: sizes not in [1, 32768], focal lengths not
  /// finite or not positive, a principal point or coefficient that is not finite.
  explicit Lens(const Parameters& parameters);

  const Parameters& parameters() const { return p_; }
  LensModel model() const { return p_.model; }
  int width() const { return p_.width; }
  int height() const { return p_.height; }
  bool has_distortion() const { return has_distortion_; }

  /// Pixel that sees `p_camera`, or nothing where the model does not hold: behind the camera
  /// (perspective models) or beyond max_radius(). The pixel may lie outside the image.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p_camera) const;

  /// Ray (unit length, camera frame) that is seen at `pixel`, or nothing where the model folds
  /// back before it reaches that pixel. Inverse of project() to 1e-9 px or better.
  std::optional<Eigen::Vector3d> unproject(const Eigen::Vector2d& pixel) const;

  /// Polynomials fold back outside a radius: two directions then share one pixel. Up to this
  /// undistorted radius the radial function grows strictly: r = sqrt(x^2+y^2)/z for the
  /// perspective models, the angle theta from the axis in radians for equidistant. What lies
  /// outside counts as unseen.
  double max_radius() const { return max_radius_; }

  /// Largest angle from the optical axis that any pixel of the image sees, in radians.
  double max_angle() const { return max_angle_; }

 private:
  double radial(double r) const;  // distorted radius for an undistorted one, without tangential terms
  void find_max_radius();
  void find_max_angle();

  Parameters p_;
  bool has_distortion_ = false;
  double max_radius_ = 0;
  double max_angle_ = 0;
};

}  // namespace foresight
