#include "prediction/online_regression.hpp"

#include <cmath>

namespace foresight {

OnlineRegression::OnlineRegression(const Weights& prior, const Weights& strength, double memory)
    : prior_(prior),
      strength_(strength),
      b_(strength.cwiseProduct(prior)),
      weights_(prior),
      A_(strength.asDiagonal()),
      memory_(memory) {}

void OnlineRegression::forget(double seconds) noexcept {
  const double kept = std::exp(-seconds / memory_);
  A_ *= kept;
  b_ *= kept;
  A_.diagonal() += (1 - kept) * strength_;
  b_ += (1 - kept) * strength_.cwiseProduct(prior_);
  solved_ = false;
}

void OnlineRegression::add(const Weights& x, double y, double trust) noexcept {
  if (!x.allFinite() || !std::isfinite(y)) return;
  A_.noalias() += trust * x * x.transpose();
  b_ += trust * y * x;
  solved_ = false;
}

void OnlineRegression::solve() noexcept {
  if (solved_) return;
  factor_.compute(A_);
  weights_ = factor_.solve(b_);
  if (!weights_.allFinite()) weights_ = prior_;
  solved_ = true;
}

const Weights& OnlineRegression::weights() noexcept {
  solve();
  return weights_;
}

double OnlineRegression::spread(const Weights& x) const noexcept {
  return factor_.cols() == x.size() ? x.dot(factor_.solve(x)) : 0;
}

}  // namespace foresight
