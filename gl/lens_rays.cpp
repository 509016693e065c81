#include "gl/lens_rays.hpp"

#include <array>
#include <cmath>
#include <vector>

namespace foresight::gl {
namespace {

constexpr int kStep = 4;         // px between rays that are found by the model
constexpr double kSmooth = 0.7;  // of the radius at which a lens folds back: up to there rays change evenly

/// Of nodes at -1, 0, 1 and 2: the cubic through them (Lagrange) at 0 <= f < 1.
std::array<double, 4> weights_at(double f) {
  return {-f * (f - 1) * (f - 2) / 6, (f + 1) * (f - 1) * (f - 2) / 2, -(f + 1) * f * (f - 2) / 2,
          (f + 1) * f * (f - 1) / 6};
}

/// x, y, z and 1; 0 where there is none.
Eigen::Vector4d ray_at(const Lens& lens, int x, int y) {
  const auto ray = lens.unproject({x, y});
  return ray ? Eigen::Vector4d(ray->x(), ray->y(), ray->z(), 1) : Eigen::Vector4d::Zero();
}

bool is_smooth_at(const Lens& lens, const Eigen::Vector4d& ray) {
  if (ray.w() == 0) return false;
  const double radius = lens.model() == LensModel::equidistant ? std::atan2(ray.head<2>().norm(), ray.z())
                                                               : ray.head<2>().norm() / ray.z();
  return radius < kSmooth * lens.max_radius();
}

/// Rays of each kStep-th pixel, from one before the first to two beyond the last of each row and column; 0 where those
/// beside cannot be told from it.
class RayGrid {
 public:
  explicit RayGrid(const Lens& lens) : columns_((lens.width() - 1) / kStep + 4) {
    const int rows = (lens.height() - 1) / kStep + 4;
    nodes_.reserve(static_cast<std::size_t>(columns_ * rows));
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns_; ++x) {
        const Eigen::Vector4d ray = ray_at(lens, kStep * (x - 1), kStep * (y - 1));
        nodes_.push_back(is_smooth_at(lens, ray) ? ray : Eigen::Vector4d::Zero());
      }
  }

  /// Of row `y`; columns stay kStep apart. 0 where a ray is missing.
  std::vector<Eigen::Vector4d> row(int y) const {
    const auto weights = weights_at(static_cast<double>(y % kStep) / kStep);
    std::vector<Eigen::Vector4d> out(static_cast<std::size_t>(columns_), Eigen::Vector4d::Zero());
    for (int x = 0; x < columns_; ++x) {
      bool known = true;
      for (int k = 0; k < 4; ++k) {
        const Eigen::Vector4d& node = nodes_[static_cast<std::size_t>((y / kStep + k) * columns_ + x)];
        known = known && node.w() > 0;
        out[static_cast<std::size_t>(x)] += weights[static_cast<std::size_t>(k)] * node;
      }
      if (!known) out[static_cast<std::size_t>(x)].setZero();
    }
    return out;
  }

 private:
  int columns_;
  std::vector<Eigen::Vector4d> nodes_;
};

}  // namespace

Texture make_lens_rays(const Lens& lens) {
  if (!lens.has_distortion()) return Texture(GL_RGBA32F, 1, 1, 0, 1, "lens rays (none)");
  Texture rays(GL_RGBA32F, lens.width(), lens.height(), 0, 1, "lens rays");
  const RayGrid grid(lens);
  std::array<std::array<double, 4>, kStep> weights;
  for (int i = 0; i < kStep; ++i) weights[static_cast<std::size_t>(i)] = weights_at(static_cast<double>(i) / kStep);
  std::vector<Eigen::Vector4f> row(static_cast<std::size_t>(lens.width()));
  for (int y = 0; y < lens.height(); ++y) {
    const std::vector<Eigen::Vector4d> nodes = grid.row(y);
    for (int x = 0; x < lens.width(); ++x) {
      const Eigen::Vector4d* node = &nodes[static_cast<std::size_t>(x / kStep)];
      const auto& w = weights[static_cast<std::size_t>(x % kStep)];
      const bool known = node[0].w() > 0 && node[1].w() > 0 && node[2].w() > 0 && node[3].w() > 0;
      // Elsewhere, as where what the lens sees ends, by the model itself.
      Eigen::Vector4d ray = known ? Eigen::Vector4d(w[0] * node[0] + w[1] * node[1] + w[2] * node[2] + w[3] * node[3])
                                  : ray_at(lens, x, y);
      if (known) ray << ray.head<3>().normalized(), 1;
      row[static_cast<std::size_t>(x)] = ray.cast<float>();
    }
    glTextureSubImage2D(rays.name(), 0, 0, y, lens.width(), 1, GL_RGBA, GL_FLOAT, row.data());
  }
  return rays;
}

}  // namespace foresight::gl
