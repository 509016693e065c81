// Lens models as the solvers see them: one block of 16 parameters for every model, and a
// projection that Ceres can differentiate.
//
//   perspective   fx fy cx cy  k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4    OpenCV's order
//   equidistant   fx fy cx cy  k1 k2 k3 k4
//
// Sources: OpenCV 4.6 calib3d (distortion with rational and thin-prism terms) and its fisheye
// module (equidistant). common/lens.hpp is what the rest of the program draws with.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

namespace foresight {

enum class Distortion {
  radtan4,      ///< k1 k2 p1 p2
  radtan5,      ///< and k3
  rational,     ///< and k4 k5 k6
  thin_prism,   ///< and s1 s2 s3 s4
  equidistant,  ///< k1 k2 k3 k4 of the angle from the axis
};

inline constexpr int kLensParameters = 16;
using LensParameters = std::array<double, kLensParameters>;

std::string to_string(Distortion distortion);

/// Throws InputError naming the nearest model.
Distortion parse_distortion(std::string_view name);

/// Indices into LensParameters that `distortion` leaves free; the others stay zero.
std::vector<int> free_parameters(Distortion distortion);

/// Pixel of `p_camera` (metres, optical frame). False, `pixel` untouched, where a perspective
/// model cannot see: z not above 0. Does not look for folds: common/lens.hpp does.
template <typename T>
bool project(Distortion distortion, const T* lens, const Eigen::Matrix<T, 3, 1>& p_camera,
             Eigen::Matrix<T, 2, 1>& pixel) {
  using std::atan2;
  using std::sqrt;
  const T* d = lens + 4;
  T x, y;
  if (distortion == Distortion::equidistant) {
    const T r2 = p_camera.x() * p_camera.x() + p_camera.y() * p_camera.y();
    T scale = T(1) / p_camera.z();  // the limit on the axis, where sqrt has no derivative
    if (r2 > T(1e-24)) {
      const T r = sqrt(r2);
      const T a = atan2(r, p_camera.z()), a2 = a * a;
      scale = a * (T(1) + a2 * (d[0] + a2 * (d[1] + a2 * (d[2] + a2 * d[3])))) / r;
    } else if (!(p_camera.z() > T(0))) {
      return false;
    }
    x = scale * p_camera.x();
    y = scale * p_camera.y();
  } else {
    if (!(p_camera.z() > T(0))) return false;
    const T u = p_camera.x() / p_camera.z(), v = p_camera.y() / p_camera.z();
    const T r2 = u * u + v * v;
    T radial = T(1) + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
    if (distortion == Distortion::rational || distortion == Distortion::thin_prism)
      radial = radial / (T(1) + r2 * (d[5] + r2 * (d[6] + r2 * d[7])));
    x = u * radial + T(2) * d[2] * u * v + d[3] * (r2 + T(2) * u * u);
    y = v * radial + d[2] * (r2 + T(2) * v * v) + T(2) * d[3] * u * v;
    if (distortion == Distortion::thin_prism) {
      x += r2 * (d[8] + r2 * d[9]);
      y += r2 * (d[10] + r2 * d[11]);
    }
  }
  pixel = {lens[0] * x + lens[2], lens[1] * y + lens[3]};
  return true;
}

}  // namespace foresight
