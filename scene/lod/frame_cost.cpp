#include "scene/lod/frame_cost.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

namespace foresight {
namespace {

constexpr double kGuess = 0.02;  // weight of the guess, of a frame that tells all of one number
constexpr double kOutlier = 4;   // spreads: an interrupted frame says little of its triangles

}  // namespace

FrameCost::FrameCost(const FrameCostOptions& options)
    : options_(options), guess_(options.base_ms, options.ms_per_million, options.ms_per_node * 100), c_(guess_) {}

Eigen::Vector3d FrameCost::features(const FrameWork& work) {
  return {1, work.triangles * 1e-6, work.nodes * 1e-2};  // of like size
}

double FrameCost::expected(const FrameWork& work) const {
  return features(work).dot(c_);
}

double FrameCost::margin() const {
  return options_.sigmas * std::sqrt(spread_);
}

void FrameCost::took(const FrameWork& work, double ms) {
  if (!std::isfinite(ms) || ms < 0) return;
  const Eigen::Vector3d x = features(work);
  const double before = expected(work);
  double error = ms - before;
  const double weight = std::max(1 - options_.forgetting, 1.0 / static_cast<double>(frames_ + 1));
  const double most = frames_ > 10 ? kOutlier * std::sqrt(spread_) + 0.1 * before : std::abs(error);
  error = std::clamp(error, -most, most);
  if (frames_ > 0) spread_ += weight * (error * error - spread_);  // the first guess is nobody's error
  ++frames_;
  S_ = options_.forgetting * S_ + x * x.transpose();
  r_ = options_.forgetting * r_ + x * (before + error);
  taken_ = options_.forgetting * taken_ + before + error;
  guessed_ = options_.forgetting * guessed_ + x.dot(guess_);
  solve();
}

/// Least squares, held to the guess times what all of it takes. What comes out below zero is zero, and the others are
/// found without it.
void FrameCost::solve() {
  const Eigen::Vector3d scaled = guess_ * (taken_ / std::max(guessed_, 1e-9));
  // A frame's share in each number, so that all are held alike whatever their units.
  const Eigen::Vector3d hold = kGuess * S_.diagonal().cwiseMax(1e-9);
  std::array<bool, 3> is_zero{};
  for (int round = 0; round < 3; ++round) {
    Eigen::Matrix3d A = S_;
    A.diagonal() += hold;
    Eigen::Vector3d b = r_ + hold.cwiseProduct(scaled);
    for (int i = 0; i < 3; ++i) {
      if (!is_zero[static_cast<std::size_t>(i)]) continue;
      A.row(i).setZero();
      A.col(i).setZero();
      A(i, i) = 1;
      b[i] = 0;
    }
    c_ = A.ldlt().solve(b);
    Eigen::Index least = 0;
    if (c_.minCoeff(&least) >= 0) return;
    is_zero[static_cast<std::size_t>(least)] = true;
  }
  c_ = c_.cwiseMax(0);
}

}  // namespace foresight
