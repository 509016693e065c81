#include "prediction/swivel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace foresight {
namespace {

// Abramowitz and Stegun 4.4.45: to 7e-5. An exact one, where the answer decides, is ten times as dear.
double rough_acos(double x) {
  const double a = std::abs(x);
  const double r = std::sqrt(std::max(1 - a, 0.0)) * (1.5707288 + a * (-0.2121144 + a * (0.0742610 - 0.0187293 * a)));
  return x < 0 ? std::numbers::pi - r : r;
}

// An angle's distance from a limit to either side of a middle, where `cosine` and `sine` are those of the angle from
// the middle, times the same factor > 0 (`scale` is one over it).
double distance(double half, double cosine, double sine, double scale) {
  const double d = half - rough_acos(std::clamp(scale * cosine, -1.0, 1.0));
  return std::abs(d) < 1e-3 ? half - std::atan2(std::abs(sine), cosine) : d;
}

// The same of the angle, and of that half a turn on.
std::array<double, 2> distances(double half, double cosine, double sine, double scale) {
  const double angle = rough_acos(std::clamp(scale * cosine, -1.0, 1.0));
  std::array<double, 2> d{half - angle, half - std::numbers::pi + angle};
  if (std::abs(d[0]) < 1e-3) d[0] = half - std::atan2(std::abs(sine), cosine);
  if (std::abs(d[1]) < 1e-3) d[1] = half - std::atan2(std::abs(sine), -cosine);
  return d;
}

Eigen::Vector3d turned(const Eigen::Vector3d& v, const Eigen::Vector3d& axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return c * v + s * axis.cross(v) + (1 - c) * axis.dot(v) * axis;
}

}  // namespace

Harmonic turned_product(const Eigen::Vector3d& x, const Eigen::Vector3d& n, const Eigen::Vector3d& y) noexcept {
  const double along = x.dot(n) * n.dot(y);
  return {along, x.dot(y) - along, x.dot(n.cross(y))};
}

void SwivelAngles::add_roots(const Harmonic& f, double miss) noexcept {
  const double size = std::sqrt(f.kc * f.kc + f.ks * f.ks);
  // Where curve and limit only touch, rounding must not part them.
  if (!(size > 1e-14) || std::abs(f.k0) > size * (1 + 1e-12) + 1e-15 + miss) return;
  if (size_ + 2 > angles_.size()) return;
  const double middle = std::atan2(f.ks, f.kc), half = std::acos(std::clamp(-f.k0 / size, -1.0, 1.0));
  for (const double angle : {middle - half, middle + half})
    angles_[size_++] = angle > std::numbers::pi    ? angle - 2 * std::numbers::pi
                       : angle < -std::numbers::pi ? angle + 2 * std::numbers::pi
                                                   : angle;
}

void SwivelAngles::sort() noexcept {
  std::sort(angles_.begin(), angles_.begin() + static_cast<std::ptrdiff_t>(size_));
}

BallJoint::BallJoint(const std::array<Eigen::Vector3d, 3>& axes, const Angles& lower, const Angles& upper) : a_(axes) {
  // URDFs write right angles with few digits: the model is exactly perpendicular, and what it makes is refined after.
  a_[0] = (a_[0] - a_[0].dot(a_[1]) * a_[1]).normalized();
  a_[2] = (a_[2] - a_[2].dot(a_[1]) * a_[1]).normalized();
  e1_ = a_[1].cross(a_[0]);
  e3_ = a_[1].cross(a_[2]);
  z_ = std::atan2(a_[2].dot(e1_), a_[2].dot(a_[0]));
  for (std::size_t i = 0; i < 3; ++i) {
    const double zero = i == 1 ? z_ : 0;
    const bool ends = std::isfinite(lower[i]) && std::isfinite(upper[i]);
    middle_[i] = ends ? 0.5 * (lower[i] + upper[i]) + zero : zero;
    half_[i] = ends ? 0.5 * (upper[i] - lower[i]) : std::numeric_limits<double>::infinity();
    cos_middle_[i] = std::cos(middle_[i]), sin_middle_[i] = std::sin(middle_[i]);
    for (std::size_t end = 0; end < 2 && ends; ++end) {
      const double limit = (end == 0 ? lower[i] : upper[i]) + zero;
      cos_limit_[i][end] = std::cos(limit), sin_limit_[i][end] = std::sin(limit);
    }
  }
}

void BallJoint::add_limits(const BallTurn& turn, double miss, SwivelAngles& angles) const noexcept {
  const auto mixed = [](double s, const Harmonic& a, double c, const Harmonic& b) {
    return Harmonic{s * a.k0 - c * b.k0, s * a.kc - c * b.kc, s * a.ks - c * b.ks};
  };
  for (std::size_t end = 0; end < 2; ++end) {
    if (half_[0] < std::numbers::pi)
      angles.add_roots(mixed(sin_limit_[0][end], turn.cos_first, cos_limit_[0][end], turn.sin_first), miss);
    if (half_[2] < std::numbers::pi)
      angles.add_roots(mixed(sin_limit_[2][end], turn.cos_last, cos_limit_[2][end], turn.sin_last), miss);
    if (half_[1] < std::numbers::pi) {
      const Harmonic& f = turn.cos_middle;
      angles.add_roots({f.k0 - cos_limit_[1][end], f.kc, f.ks}, miss);
    }
  }
}

std::array<double, 2> BallJoint::margins(const BallTurn& turn, double cosine, double sine) const noexcept {
  const double x = turn.cos_middle.at(cosine, sine);
  const double c1 = turn.cos_first.at(cosine, sine), s1 = turn.sin_first.at(cosine, sine);
  const double c3 = turn.cos_last.at(cosine, sine), s3 = turn.sin_last.at(cosine, sine);
  const double rho = std::sqrt(c1 * c1 + s1 * s1);
  const double scale = rho > 1e-300 ? 1 / rho : 0;
  const auto first =
      distances(half_[0], c1 * cos_middle_[0] + s1 * sin_middle_[0], s1 * cos_middle_[0] - c1 * sin_middle_[0], scale);
  const auto last =
      distances(half_[2], c3 * cos_middle_[2] + s3 * sin_middle_[2], s3 * cos_middle_[2] - c3 * sin_middle_[2], scale);
  std::array<double, 2> out;
  for (std::size_t side = 0; side < 2; ++side) {
    const double sign = side == 0 ? 1 : -1;
    const double middle = distance(half_[1], x * cos_middle_[1] + sign * rho * sin_middle_[1],
                                   sign * rho * cos_middle_[1] - x * sin_middle_[1], 1);
    out[side] = std::min(std::min(first[side], last[side]), std::min(middle, rho));
  }
  return out;
}

BallJoint::Angles BallJoint::angles(const Eigen::Matrix3d& R, BallSide side, double first) const noexcept {
  const Eigen::Vector3d u = R * a_[2];
  const double sign = side == BallSide::positive ? 1 : -1;
  const double c1 = u.dot(e1_), s1 = u.dot(a_[1]), rho = std::hypot(c1, s1);
  Angles q;
  q[0] = rho < 1e-13 ? first : std::atan2(sign * s1, sign * c1);
  q[1] = sign * std::atan2(rho, u.dot(a_[0])) - z_;
  // What is left for the last joint makes up for the first, however little is known of that.
  const Eigen::Vector3d rest = turned(turned(R * e3_, a_[0], -q[0]), a_[1], -q[1]);
  q[2] = std::atan2(rest.dot(a_[1]), rest.dot(e3_));
  for (std::size_t i = 0; i < 3; ++i) q[i] = nearest_turn(q[i], middle_[i] - (i == 1 ? z_ : 0));
  return q;
}

Eigen::Matrix3d BallJoint::rotation(const Angles& q) const noexcept {
  Eigen::Matrix3d R;
  for (int k = 0; k < 3; ++k)
    R.col(k) = turned(turned(turned(Eigen::Vector3d::Unit(k), a_[2], q[2]), a_[1], q[1]), a_[0], q[0]);
  return R;
}

double nearest_turn(double angle, double wanted) noexcept {
  return angle + 2 * std::numbers::pi * std::round((wanted - angle) / (2 * std::numbers::pi));
}

}  // namespace foresight
