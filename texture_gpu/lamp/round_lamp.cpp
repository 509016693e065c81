#include "texture_gpu/lamp/round_lamp.hpp"

#include <array>
#include <cmath>

namespace foresight {

Disc spiral(std::size_t points) {
  Disc out;
  for (std::size_t k = 0; k < points; ++k) {
    const double r = std::sqrt((static_cast<double>(k) + 0.5) / static_cast<double>(points)),
                 a = static_cast<double>(k) * 2.39996;
    out.emplace_back(r * std::cos(a), r * std::sin(a));
  }
  return out;
}

double hidden_share(const ShadowRays::Posed& what, const Eigen::Vector3d& p, const Eigen::Vector3d& lamp, double radius,
                    const Disc& disc, double gap) {
  if (disc.empty()) return what.blocked(p, lamp, gap);
  const Eigen::Vector3d to_lamp = lamp - p, right = to_lamp.unitOrthogonal(), up = to_lamp.normalized().cross(right);
  int hits = 0;
  std::array<Eigen::Vector3d, ShadowRays::kPacket> to;
  for (std::size_t first = 0; first < disc.size(); first += to.size()) {
    for (std::size_t k = 0; k < to.size(); ++k)
      to[k] = lamp + radius * (disc[first + k].x() * right + disc[first + k].y() * up);
    hits += what.count_blocked(p, to, gap);
  }
  return static_cast<double>(hits) / static_cast<double>(disc.size());
}

}  // namespace foresight
