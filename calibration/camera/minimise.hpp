// Ceres' solver in one place: its options and its words are not compiled again with each problem.
#pragma once

#include <ceres/problem.h>
#include <ceres/types.h>

#include <string>
#include <vector>

namespace foresight {

struct MinimiseOptions {
  ceres::LinearSolverType solver = ceres::DENSE_QR;
  std::vector<double*> eliminated;  ///< with a Schur solver: blocks that share no residual; may name unused ones
  int most_iterations = 100;
  double function_tolerance = 1e-10;
  double parameter_tolerance = 1e-8;
  int threads = 1;
};

struct MinimiseSummary {
  bool usable = false;
  double cost = 0;
  std::string message;  ///< Ceres' own
};

/// Ceres and what it stands on write nothing to the error stream from here on: what went wrong is in the summary. The
/// functions below call it.
void silence_ceres();

/// Minimises over the problem's blocks, in place.
MinimiseSummary minimise(ceres::Problem& problem, const MinimiseOptions& options);

/// The same; throws RuntimeFailure "`what` does not converge" where there is no usable solution.
double minimise_or_throw(ceres::Problem& problem, const MinimiseOptions& options, const std::string& what,
                         const std::string& cure);

}  // namespace foresight
