#include "calibration/registration/motion_model.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace foresight {
namespace {

constexpr double kStartPx = 100;       // where the line starts: unknown
constexpr double kSlopeReach = 10;     // reaches per second: how steep it is
constexpr double kRoundingPx2 = 1e-4;  // keeps given poses that all tell the same apart

double square(double x) {
  return x * x;
}

double covariance(const MotionModel& model, double a, double b) {
  return square(model.reach_px) * std::exp(-0.5 * square((a - b) / model.smooth_s)) + square(kStartPx) +
         square(kSlopeReach * model.reach_px) * a * b;
}

double error_covariance(const MotionModel& model, double a, double b) {
  if (model.persist_s <= 0) return a == b ? square(model.given_px) : 0;
  return square(model.given_px) * std::exp(-std::abs(a - b) / model.persist_s);
}

}  // namespace

MotionWeights motion_weights(const MotionModel& model, const Eigen::VectorXd& refined, const Eigen::VectorXd& given,
                             double wanted) {
  Eigen::VectorXd t(refined.size() + given.size());
  t << refined, given;
  Eigen::MatrixXd K(t.size(), t.size());
  Eigen::VectorXd k(t.size());
  for (Eigen::Index i = 0; i < t.size(); ++i) {
    k[i] = covariance(model, t[i], wanted);
    for (Eigen::Index j = 0; j < t.size(); ++j) {
      K(i, j) = covariance(model, t[i], t[j]);
      if (i >= refined.size() && j >= refined.size()) K(i, j) += error_covariance(model, t[i], t[j]);
    }
    K(i, i) += i < refined.size() ? square(model.refined_px) : kRoundingPx2;
  }
  const Eigen::VectorXd weights = K.ldlt().solve(k);
  const double variance = covariance(model, wanted, wanted) - k.dot(weights);
  return {weights.head(refined.size()), weights.tail(given.size()),
          std::sqrt(std::max(variance, square(model.refined_px)))};
}

}  // namespace foresight
