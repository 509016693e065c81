#include "sim/woven.hpp"

#include <algorithm>
#include <cmath>

#include "scene/mesh_builder.hpp"

namespace foresight::sim {
namespace {

constexpr double kRound = 2 * EIGEN_PI;

/// About square cells: so many along, for what is so many times as long as it is around.
Weave weave_of(std::size_t triangles, double length_share, int fewest_along) {
  const double quads = std::max(24.0, static_cast<double>(triangles) / 2);
  const int across = std::max(6, static_cast<int>(std::sqrt(quads / length_share)));
  const int along = std::max(fewest_along, static_cast<int>(quads / across));
  return {along, across, false, true};
}

double rounded(double cosine, double power) {
  return std::copysign(std::pow(std::abs(cosine), power), cosine);
}

}  // namespace

Mesh woven(const Weave& weave, const WovenSurface& surface) {
  std::vector<Eigen::Vector3f> points;
  const int rows = weave.along + 1, columns = weave.across + 1;
  for (int i = 0; i < rows; ++i)
    for (int k = 0; k < columns; ++k) {
      const double u = static_cast<double>(weave.closed_along ? i % weave.along : i) / weave.along;
      const double v = static_cast<double>(weave.closed_across ? k % weave.across : k) / weave.across;
      points.push_back(surface(u, v).cast<float>());
    }
  MeshBuilder out;
  for (int i = 0; i < weave.along; ++i)
    for (int k = 0; k < weave.across; ++k) {
      const auto at = [&](int row, int column) { return points[static_cast<std::size_t>(row * columns + column)]; };
      const std::array<Eigen::Vector3f, 3> first{at(i, k), at(i, k + 1), at(i + 1, k + 1)},
          second{at(i, k), at(i + 1, k + 1), at(i + 1, k)};
      out.add(first);
      out.add(second);
    }
  return std::move(out).take();
}

Mesh turned_solid(std::size_t triangles, double reach, std::mt19937& random) {
  std::uniform_real_distribution any(0.0, 1.0);
  const double height = reach * (1.1 + 2.2 * any(random)), waves = 1 + 4 * any(random), phase = 6 * any(random);
  return woven(weave_of(triangles, 1, 3), [=](double u, double v) -> Eigen::Vector3d {
    const double a = kRound * v;
    const double radius =
        reach * std::sqrt(std::max(0.0, 1 - std::pow(2 * u - 1, 6))) * (0.7 + 0.3 * std::sin(waves * u * 6 + phase));
    return {radius * std::cos(a), radius * std::sin(a), u * height};
  });
}

Mesh tube(std::size_t triangles, double radius, const std::function<Eigen::Vector3d(double u)>& way) {
  double length = 0;
  for (int i = 0; i < 100; ++i) length += (way((i + 1) / 100.0) - way(i / 100.0)).norm();
  return woven(weave_of(triangles, std::max(1.0, length / (kRound * radius)), 4), [&](double u, double v) {
    constexpr double kStep = 1e-4;
    const Eigen::Vector3d ahead = (way(std::min(1.0, u + kStep)) - way(std::max(0.0, u - kStep))).normalized();
    const Eigen::Vector3d side = ahead.unitOrthogonal(), up = ahead.cross(side);
    return Eigen::Vector3d(way(u) + radius * (std::cos(kRound * v) * side + std::sin(kRound * v) * up));
  });
}

Mesh toothed_wheel(std::size_t triangles, double radius, double width, int teeth) {
  Weave weave = weave_of(triangles, 0.3, 8);
  weave.closed_along = false;
  return woven(weave, [=](double u, double v) -> Eigen::Vector3d {
    // Around the wheel by v, by u from the hub's lower side over the teeth to its upper side.
    const double tooth = 1 - 0.12 / (1 + std::exp(12 * std::sin(kRound * v * teeth)));
    const double out = u < 0.4 ? u / 0.4 : u > 0.6 ? (1 - u) / 0.4 : 1;
    const double up = std::clamp((u - 0.4) / 0.2, 0.0, 1.0);
    const double r = radius * (0.2 + 0.8 * out * tooth);
    return {r * std::cos(kRound * v), r * std::sin(kRound * v), width * up};
  });
}

Mesh cast_block(std::size_t triangles, const Eigen::Vector3d& size, std::mt19937& random) {
  std::uniform_real_distribution any(0.0, 1.0);
  const double dents = 3 + 6 * any(random), phase = kRound * any(random);
  return woven(weave_of(triangles, 0.5, 4), [=](double u, double v) -> Eigen::Vector3d {
    constexpr double kEdges = 0.3;  // of the power: 1 is an ellipsoid, 0 a box
    const double up = EIGEN_PI * (u - 0.5), around = kRound * v;
    const double dent = 1 - 0.03 * (1 + std::sin(dents * up + phase) * std::cos(dents * around));
    const double flat = rounded(std::cos(up), kEdges) * dent;
    return {0.5 * size.x() * flat * rounded(std::cos(around), kEdges),
            0.5 * size.y() * flat * rounded(std::sin(around), kEdges),
            0.5 * size.z() * (1 + rounded(std::sin(up), kEdges))};
  });
}

}  // namespace foresight::sim
