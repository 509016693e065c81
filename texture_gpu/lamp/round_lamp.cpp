#include "texture_gpu/lamp/round_lamp.hpp"

#include <Eigen/Geometry>
#include <bit>
#include <cmath>

namespace foresight {

Disc spiral(int points) {
  Disc out(2, points);
  for (int k = 0; k < points; ++k) {
    const double r = std::sqrt((k + 0.5) / points), a = k * 2.39996;
    out.col(k) = Eigen::Vector2d(r * std::cos(a), r * std::sin(a)).cast<float>();
  }
  return out;
}

double hidden_share(const ShadowRays::Posed& what, const Eigen::Vector3d& p, const Eigen::Vector3d& lamp, double radius,
                    const Disc& disc, double gap) {
  if (disc.cols() == 0) return what.blocked(p, lamp, gap);
  const Eigen::Vector3d to_lamp = lamp - p, right = to_lamp.unitOrthogonal(), up = to_lamp.normalized().cross(right);
  Eigen::Matrix<float, 3, 2> across;
  across << (radius * right).cast<float>(), (radius * up).cast<float>();
  const ShadowRays::Points from = p.cast<float>().replicate<1, ShadowRays::kPacket>();
  int hits = 0;
  for (Eigen::Index first = 0; first < disc.cols(); first += ShadowRays::kPacket) {
    const ShadowRays::Points to = (across * disc.middleCols<ShadowRays::kPacket>(first)).colwise() + lamp.cast<float>();
    hits += std::popcount(what.blocked(from, to, ShadowRays::kPacket, gap));
  }
  return static_cast<double>(hits) / static_cast<double>(disc.cols());
}

}  // namespace foresight
