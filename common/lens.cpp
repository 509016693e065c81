#include "common/lens.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace foresight {
namespace {

// Perspective models reach towards 90 degrees only in the limit; 60 (89 degrees) is beyond every
// lens for which they are used.
constexpr double kLargestPerspectiveRadius = 60.0;

struct Distorted {
  Eigen::Vector2d point;
  Eigen::Matrix2d jacobian;
};

// OpenCV's rational model with tangential terms, and its derivative, at a normalised point.
Distorted distort(const std::array<double, 8>& d, const Eigen::Vector2d& n) {
  const auto [k1, k2, p1, p2, k3, k4, k5, k6] = d;
  const double x = n.x(), y = n.y(), r2 = n.squaredNorm();
  const double num = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double den = 1 + r2 * (k4 + r2 * (k5 + r2 * k6));
  const double dnum = k1 + r2 * (2 * k2 + 3 * r2 * k3);
  const double dden = k4 + r2 * (2 * k5 + 3 * r2 * k6);
  const double s = num / den;
  const double ds = (dnum * den - num * dden) / (den * den);  // d s / d r^2

  Distorted out;
  out.point = {x * s + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), y * s + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
  out.jacobian << s + 2 * x * x * ds + 2 * p1 * y + 6 * p2 * x, 2 * x * y * ds + 2 * p1 * x + 2 * p2 * y,
      2 * x * y * ds + 2 * p1 * x + 2 * p2 * y, s + 2 * y * y * ds + 6 * p1 * y + 2 * p2 * x;
  return out;
}

double equidistant_radius(const std::array<double, 8>& d, double theta) {
  const double t2 = theta * theta;
  return theta * (1 + t2 * (d[0] + t2 * (d[1] + t2 * (d[2] + t2 * d[3]))));
}

// Of Lens::radial().
double radial_slope(const Lens::Parameters& p, double r) {
  const double r2 = r * r;
  const auto& d = p.d;
  if (p.model == LensModel::equidistant) return 1 + r2 * (3 * d[0] + r2 * (5 * d[1] + r2 * (7 * d[2] + r2 * 9 * d[3])));
  const double num = 1 + r2 * (d[0] + r2 * (d[1] + r2 * d[4])), den = 1 + r2 * (d[5] + r2 * (d[6] + r2 * d[7]));
  const double num_slope = d[0] + r2 * (2 * d[1] + r2 * 3 * d[4]), den_slope = d[5] + r2 * (2 * d[6] + r2 * 3 * d[7]);
  return (num * den + 2 * r2 * (num_slope * den - num * den_slope)) / (den * den);
}

// Where `radial`, which grows from 0 to `high`, is `wanted`: Newton's steps between bounds that close in; where one
// would leave them, half way.
template <typename Radial, typename Slope>
double radius_at(double wanted, double high, const Radial& radial, const Slope& slope) {
  double low = 0, r = std::min(wanted, high / 2);
  for (int i = 0; i < 100 && high - low > 1e-16 * (1 + high); ++i) {
    const double off = radial(r) - wanted;
    (off < 0 ? low : high) = r;
    double next = r - off / slope(r);
    if (!(next >= low && next <= high)) next = (low + high) / 2;
    if (std::abs(next - r) <= 4e-16 * (1 + r)) return next;
    r = next;
  }
  return r;
}

}  // namespace

std::string to_string(LensModel model) {
  switch (model) {
    case LensModel::plumb_bob: return "plumb_bob";
    case LensModel::rational_polynomial: return "rational_polynomial";
    case LensModel::equidistant: return "equidistant";
  }
  return "unknown";
}

Lens::Lens(const Parameters& parameters) : p_(parameters) {
  const auto require = [](bool ok, const char* text) {
    if (!ok) throw std::invalid_argument(text);
  };
  require(p_.width >= 1 && p_.width <= 32768, "image width must lie in 1 .. 32768");
  require(p_.height >= 1 && p_.height <= 32768, "image height must lie in 1 .. 32768");
  require(std::isfinite(p_.fx) && p_.fx > 0, "fx must be finite and positive");
  require(std::isfinite(p_.fy) && p_.fy > 0, "fy must be finite and positive");
  require(std::isfinite(p_.cx), "cx must be finite");
  require(std::isfinite(p_.cy), "cy must be finite");
  for (double c : p_.d) require(std::isfinite(c), "distortion coefficients must be finite");
  has_distortion_ =
      p_.model == LensModel::equidistant || std::any_of(p_.d.begin(), p_.d.end(), [](double c) { return c != 0; });
  find_max_radius();
  find_max_angle();
}

double Lens::radial(double r) const {
  if (p_.model == LensModel::equidistant) return equidistant_radius(p_.d, r);
  const double r2 = r * r;
  const double num = 1 + r2 * (p_.d[0] + r2 * (p_.d[1] + r2 * p_.d[4]));
  const double den = 1 + r2 * (p_.d[5] + r2 * (p_.d[6] + r2 * p_.d[7]));
  return den > 0 ? r * num / den : -1;
}

// Walks outwards until the radial function stops growing, then narrows the place by bisection.
void Lens::find_max_radius() {
  const bool fisheye = p_.model == LensModel::equidistant;
  const double limit = fisheye ? std::numbers::pi : kLargestPerspectiveRadius;
  constexpr int kSteps = 20000;
  double previous = 0;
  for (int i = 1; i <= kSteps; ++i) {
    // Quadratic spacing: fine near the axis, where perspective radii of real lenses lie.
    const double r = limit * (static_cast<double>(i) / kSteps) * (fisheye ? 1.0 : static_cast<double>(i) / kSteps);
    const double value = radial(r);
    if (!(value > previous)) {
      // The maximum lies between the last three samples.
      const double two_back = std::max(1 - 2.0 / i, 0.0);
      double low = r * two_back * (fisheye ? 1.0 : two_back), high = r;
      for (int k = 0; k < 60; ++k) {
        const double a = low + (high - low) / 3, b = high - (high - low) / 3;
        (radial(a) < radial(b) ? low : high) = radial(a) < radial(b) ? a : b;
      }
      max_radius_ = low;
      return;
    }
    previous = value;
  }
  max_radius_ = limit;
}

void Lens::find_max_angle() {
  max_angle_ = 0;
  const double w = p_.width - 0.5, h = p_.height - 0.5;
  constexpr int kSamples = 32;  // along each border; the farthest pixel lies on the border
  for (int i = 0; i <= kSamples; ++i) {
    const double s = static_cast<double>(i) / kSamples;
    const Eigen::Vector2d border[] = {{-0.5 + s * (w + 0.5), -0.5},
                                      {-0.5 + s * (w + 0.5), h},
                                      {-0.5, -0.5 + s * (h + 0.5)},
                                      {w, -0.5 + s * (h + 0.5)}};
    for (const auto& pixel : border) {
      const auto ray = unproject(pixel);
      const double angle = ray ? std::acos(std::clamp(ray->z(), -1.0, 1.0))
                               : (p_.model == LensModel::equidistant ? max_radius_ : std::atan(max_radius_));
      max_angle_ = std::max(max_angle_, angle);
    }
  }
}

std::optional<Eigen::Vector2d> Lens::project(const Eigen::Vector3d& p_camera) const {
  if (p_.model == LensModel::equidistant) {
    const double rho = p_camera.head<2>().norm();
    const double theta = std::atan2(rho, p_camera.z());
    if (!(theta <= max_radius_)) return std::nullopt;
    const double scale = rho > 1e-12 ? equidistant_radius(p_.d, theta) / rho : 1.0 / p_camera.z();
    return Eigen::Vector2d(p_.fx * p_camera.x() * scale + p_.cx, p_.fy * p_camera.y() * scale + p_.cy);
  }
  if (!(p_camera.z() > 0)) return std::nullopt;
  const Eigen::Vector2d n = p_camera.head<2>() / p_camera.z();
  if (!(n.norm() <= max_radius_)) return std::nullopt;
  const Eigen::Vector2d q = has_distortion_ ? distort(p_.d, n).point : n;
  return Eigen::Vector2d(p_.fx * q.x() + p_.cx, p_.fy * q.y() + p_.cy);
}

std::optional<Eigen::Vector3d> Lens::unproject(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d q((pixel.x() - p_.cx) / p_.fx, (pixel.y() - p_.cy) / p_.fy);
  // The radial function grows strictly up to max_radius_, so its radius is always found; Newton steps then add the
  // tangential terms.
  const double wanted = q.norm();
  if (!has_distortion_) {
    if (wanted > max_radius_) return std::nullopt;
    return Eigen::Vector3d(q.x(), q.y(), 1).normalized();
  }
  const double r = radius_at(
      wanted, max_radius_, [this](double x) { return radial(x); }, [this](double x) { return radial_slope(p_, x); });
  if (p_.model == LensModel::equidistant) {
    if (wanted > radial(max_radius_)) return std::nullopt;
    const Eigen::Vector2d direction = wanted > 1e-15 ? Eigen::Vector2d(q / wanted) : Eigen::Vector2d(0, 0);
    return Eigen::Vector3d(direction.x() * std::sin(r), direction.y() * std::sin(r), std::cos(r));
  }
  Eigen::Vector2d n = wanted > 1e-15 ? Eigen::Vector2d(q * (r / wanted)) : q;
  for (int i = 0; i < 20; ++i) {
    const Distorted at = distort(p_.d, n);
    const Eigen::Vector2d step = at.jacobian.inverse() * (q - at.point);
    if (!step.allFinite()) return std::nullopt;
    n += step;
    if (step.norm() < 1e-15 * (1 + n.norm())) break;
  }
  if (!(n.norm() <= max_radius_) || (distort(p_.d, n).point - q).norm() > 1e-9) return std::nullopt;
  return Eigen::Vector3d(n.x(), n.y(), 1).normalized();
}

}  // namespace foresight
