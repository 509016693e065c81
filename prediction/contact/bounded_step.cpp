#include "prediction/contact/bounded_step.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

constexpr int kSweeps = 400;
constexpr double kStill = 1e-10;  // rad or m that a sweep changes at most, once it is done

using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, static_cast<int>(kMostArmJoints),
                             static_cast<int>(kMostArmJoints)>;

// Lets `x` lean on row . x >= least by as much as it must, `away` = H^-1 row. Returns how much x changed.
double lean(JointVector& x, double along, double least, double stiffness, const JointVector& away, double& pressed) {
  if (!(stiffness > 1e-14)) return 0;
  const double push = std::max(-pressed, (least - along) / stiffness);
  if (push == 0) return 0;
  pressed += push;
  x += push * away;
  return std::abs(push) * away.cwiseAbs().maxCoeff();
}

}  // namespace

JointVector bounded_step(const TipChange& change, const Vector6& e, double mu, const JointVector& lower,
                         const JointVector& upper, std::span<ClosedWay> closed) noexcept {
  const Eigen::Index n = lower.size();
  Square H = mu * Square::Identity(n, n);
  JointVector wanted(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    wanted[i] = change[static_cast<std::size_t>(i)].dot(e);
    for (Eigen::Index k = 0; k < n; ++k)
      H(i, k) += change[static_cast<std::size_t>(i)].dot(change[static_cast<std::size_t>(k)]);
  }
  const Square inverse = H.llt().solve(Square::Identity(n, n));
  JointVector x = inverse * wanted;
  JointVector at_lower = JointVector::Zero(n), at_upper = JointVector::Zero(n);
  closed = closed.first(std::min(closed.size(), kMostClosedWays));
  std::array<JointVector, kMostClosedWays> away;
  for (std::size_t k = 0; k < closed.size(); ++k) {
    closed[k].pressed = 0;
    away[k] = inverse * closed[k].row;
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    double moved = 0;
    for (std::size_t k = 0; k < closed.size(); ++k) {
      ClosedWay& way = closed[k];
      moved = std::max(moved, lean(x, way.row.dot(x), way.least, way.row.dot(away[k]), away[k], way.pressed));
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      const JointVector column = inverse.col(i), minus = -column;
      moved = std::max(moved, lean(x, x[i], lower[i], column[i], column, at_lower[i]));
      moved = std::max(moved, lean(x, -x[i], -upper[i], column[i], minus, at_upper[i]));
    }
    if (moved <= kStill) break;
  }
  return x.cwiseMax(lower).cwiseMin(upper);
}

}  // namespace foresight
