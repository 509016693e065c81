// Weights of a linear model, learnt while the samples come: recursive least squares with a prior that old samples fade
// back into.
//
//   w = argmin  sum_i f_i |y_i - x_i w|^2  +  (w - prior)^T S (w - prior),   f_i = exp(-age_i / memory)
//
// In information form (A w = b), so that forgetting never loses what the prior knows: directions that nothing was seen
// of stay at the prior, and A stays positive definite (Ljung and Soederstroem, Theory and Practice of Recursive
// Identification, 1983; the fading prior is the "regularised" form of Gunnarsson 1996).
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace foresight {

inline constexpr int kMostWeights = 16;

/// Never allocates.
using Weights = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostWeights, 1>;

/// One thread. No method allocates or throws.
class OnlineRegression {
 public:
  OnlineRegression() = default;
  /// `prior`: the weights as long as nothing is known, at most kMostWeights. `strength` > 0, one each: how firmly, as
  /// the sum of squares of that weight's inputs over which samples begin to count more. `memory`: seconds, > 0.
  OnlineRegression(const Weights& prior, const Weights& strength, double memory);

  /// Lets what was learnt fade by `seconds` >= 0.
  void forget(double seconds) noexcept;
  /// One sample: `y` was seen for inputs `x`, with the weight `trust` > 0. What is not finite is passed over.
  void add(const Weights& x, double y, double trust = 1) noexcept;

  /// Solves when something was added since.
  const Weights& weights() noexcept;
  double predict(const Weights& x) noexcept { return weights().dot(x); }
  /// x^T A^-1 x of what weights() last solved: times the variance of one y, the variance of predict(x) that the weights
  /// are the reason of. 0 before that.
  double spread(const Weights& x) const noexcept;

 private:
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostWeights, kMostWeights>;
  void solve() noexcept;

  Weights prior_, strength_, b_, weights_;
  Matrix A_;
  Eigen::LLT<Matrix> factor_{Matrix()};
  double memory_ = 1;
  bool solved_ = false;
};

}  // namespace foresight
