#include "sim/pose_error.hpp"

#include <cmath>
#include <random>

namespace foresight::sim {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

Pose motion(const Vector6d& rotation_translation) {
  const Eigen::Vector3d rotation = rotation_translation.head<3>();
  Pose out = Pose::Identity();
  out.translate(Eigen::Vector3d(rotation_translation.tail<3>()));
  if (rotation.norm() > 0) out.rotate(Eigen::AngleAxisd(rotation.norm(), rotation.normalized()));
  return out;
}

Vector6d draw(unsigned seed, int number) {
  std::seed_seq key{seed, static_cast<unsigned>(number), 0x706f7365u};
  std::mt19937_64 random(key);
  std::normal_distribution<double> normal;
  Vector6d out;
  for (double& x : out) x = normal(random);
  return out;
}

/// A first-order autoregression from the infinite past, up to a factor.
Vector6d direction_of(unsigned seed, int number, double persistence) {
  constexpr double kForgotten = 1e-3;
  Vector6d sum = draw(seed, number);
  double share = persistence;
  for (int ago = 1; share > kForgotten; ++ago, share *= persistence) sum += share * draw(seed, number - ago);
  return sum;
}

}  // namespace

double displacement_px(const Lens& lens, const cv::Mat& depth, const Pose& error) {
  const Pose T_wrong_camera = error.inverse();
  double sum = 0;
  std::size_t count = 0;
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      const double z = depth.at<float>(v, u);
      if (!(z > 0)) continue;
      const Eigen::Vector2d pixel(u, v);
      const auto ray = lens.unproject(pixel);
      if (!ray) continue;
      const auto seen = lens.project(T_wrong_camera * (*ray * (z / ray->z())));
      if (!seen) continue;
      sum += (*seen - pixel).squaredNorm();
      ++count;
    }
  return count ? std::sqrt(sum / static_cast<double>(count)) : 0;
}

Pose random_pose_error(const Lens& lens, const cv::Mat& depth, double px, unsigned seed, int number,
                       double persistence) {
  const double mean_depth = cv::mean(depth, depth > 0)[0];
  if (px == 0 || !(mean_depth > 0)) return Pose::Identity();
  Vector6d direction = direction_of(seed, number, persistence);
  direction.tail<3>() *= mean_depth;
  // Almost linear in its size, so that a few steps of the secant reach it.
  double size = px / lens.parameters().fx / direction.head<3>().norm();
  for (int step = 0; step < 20; ++step) {
    const double now = displacement_px(lens, depth, motion(size * direction));
    if (std::abs(now - px) <= 1e-6 * px) break;
    size *= px / now;
  }
  return motion(size * direction);
}

}  // namespace foresight::sim
