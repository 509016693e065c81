#include "tests/texture_gpu/reference/seeing.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace foresight::reference {
namespace {

/// The face whose axis is nearest to p, and p in that face's frame.
std::pair<std::size_t, Eigen::Vector3d> face_of(const gl::Faces& faces, const Eigen::Vector3d& p) {
  std::size_t best = 0;
  for (int i = 1; i < faces.count; ++i)
    if ((gl::Faces::rotation(i) * p).z() > (gl::Faces::rotation(static_cast<int>(best)) * p).z())
      best = static_cast<std::size_t>(i);
  return {best, gl::Faces::rotation(static_cast<int>(best)) * p};
}

bool seen_at(const Camera& camera, std::size_t face, const Eigen::Vector2d& place, double z, double tolerance) {
  const FacePicture& depth = camera.depth[face];
  if (place.x() < -0.5 || place.y() < -0.5 || place.x() > depth.width - 0.5 || place.y() > depth.height - 0.5)
    return false;
  double least = 1e30, largest = 0;
  for (int i = 0; i < 4; ++i) {
    const int x = std::clamp(static_cast<int>(std::floor(place.x())) + (i & 1), 0, depth.width - 1);
    const int y = std::clamp(static_cast<int>(std::floor(place.y())) + (i >> 1), 0, depth.height - 1);
    const auto at = static_cast<std::size_t>(y * depth.width + x);
    if (camera.uncertain[face][at]) return false;
    if (depth.inverse_z[at] == 0) continue;  // no model: between it and an occluder lies all that is hidden
    least = std::min(least, depth.inverse_z[at]);
    largest = std::max(largest, depth.inverse_z[at]);
  }
  // Beyond the farthest of the four: hidden. Before the nearest (or nothing there): beside the surface.
  if (largest == 0) return false;
  const double farthest = 1 / least, nearest = 1 / largest;
  return z - 0.05 * tolerance <= farthest && z + tolerance >= nearest;
}

bool in_image(const Lens& lens, const Eigen::Vector2d& pixel, double slack) {
  return pixel.x() >= 0.5 - slack && pixel.y() >= 0.5 - slack && pixel.x() <= lens.width() - 1.5 + slack &&
         pixel.y() <= lens.height() - 1.5 + slack;
}

double cubic(double t) {
  t = std::abs(t);
  if (t < 1) return 1 + t * t * (-2.5 + 1.5 * t);
  return t < 2 ? 2 + t * (-4 + t * (2.5 - 0.5 * t)) : 0;
}

Eigen::Vector3d rgb(const cv::Mat& bgr, int x, int y) {
  const auto& v = bgr.at<cv::Vec3b>(std::clamp(y, 0, bgr.rows - 1), std::clamp(x, 0, bgr.cols - 1));
  return Eigen::Vector3d(v[2], v[1], v[0]) / 255;
}

}  // namespace

Answer is_seen(const Camera& camera, const Eigen::Vector3d& p, double tolerance, Eigen::Vector2d& pixel) {
  const auto [face, q] = face_of(camera.faces, p);
  if (std::abs(q.z() - gl::kNearPlane) < 1e-6) return Answer::borderline;
  if (q.z() < gl::kNearPlane) return Answer::no;
  const auto& f = camera.faces;
  const Eigen::Vector2d place(f.fx * q.x() / q.z() + f.cx, f.fy * q.y() / q.z() + f.cy);
  const auto found = camera.lens.project(p);
  pixel = found.value_or(Eigen::Vector2d(-1e6, -1e6));
  int yes = 0, all = 0;
  constexpr double kShift = 0.005, kDepth = 2e-5;
  for (double dx : {-kShift, kShift})
    for (double dy : {-kShift, kShift})
      for (double dz : {-kDepth, kDepth}) {
        ++all;
        yes += seen_at(camera, face, place + Eigen::Vector2d(dx, dy), q.z() * (1 + dz), tolerance) &&
               in_image(camera.lens, pixel, dx);
      }
  return yes == 0 ? Answer::no : yes == all ? Answer::yes : Answer::borderline;
}

Eigen::Vector3d catmull_rom(const cv::Mat& bgr, const Eigen::Vector2d& pixel) {
  const int x0 = static_cast<int>(std::floor(pixel.x())), y0 = static_cast<int>(std::floor(pixel.y()));
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int y = y0 - 1; y <= y0 + 2; ++y)
    for (int x = x0 - 1; x <= x0 + 2; ++x) sum += cubic(pixel.x() - x) * cubic(pixel.y() - y) * rgb(bgr, x, y);
  return sum.cwiseMax(0).cwiseMin(1);
}

Eigen::Vector3d mean_over(const cv::Mat& bgr, const Eigen::Vector2d& pixel, const Eigen::Matrix2d& axes) {
  constexpr int kSamples = 24;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int j = 0; j < kSamples; ++j)
    for (int i = 0; i < kSamples; ++i) {
      const Eigen::Vector2d at = pixel + axes * Eigen::Vector2d((i + 0.5) / kSamples - 0.5, (j + 0.5) / kSamples - 0.5);
      sum += rgb(bgr, static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
    }
  return sum / (kSamples * kSamples);
}

Eigen::Matrix2d footprint(const Camera& camera, const Eigen::Vector3d& p, const Eigen::Vector3d& eu,
                          const Eigen::Vector3d& ev) {
  const auto& k = camera.lens.parameters();
  if (camera.lens.model() == LensModel::equidistant) {
    // Focal lengths times angles along two directions across the ray; their order does not matter
    // for lengths and area where fx and fy are nearly the same.
    const Eigen::Vector3d d = p.normalized(), x = d.unitOrthogonal(), y = d.cross(x);
    const double f = std::sqrt(k.fx * k.fy) / p.norm();
    Eigen::Matrix2d axes;
    axes << eu.dot(x), ev.dot(x), eu.dot(y), ev.dot(y);
    return f * axes;
  }
  const auto project = [&](const Eigen::Vector3d& q) {
    return Eigen::Vector2d(k.fx * q.x() / q.z(), k.fy * q.y() / q.z());
  };
  constexpr double h = 1e-3;
  Eigen::Matrix2d axes;
  axes << (project(p + h * eu) - project(p - h * eu)) / (2 * h), (project(p + h * ev) - project(p - h * ev)) / (2 * h);
  return axes;
}

double quality_code(double pixels_per_texel) {
  return 2 + std::round(std::clamp((std::log2(pixels_per_texel) + 8) / 8, 0.0, 1.0) * 29);
}

Fused fuse(double old_code, double fresh_code, double worse, bool its_turn) {
  if (fresh_code == 0) return {false, old_code};
  if (old_code < 2 || fresh_code >= old_code + std::log2(worse) * 29 / 8) return {true, fresh_code};
  return {false, its_turn ? std::max(old_code - 1, 2.0) : old_code};
}

}  // namespace foresight::reference
