#include "calibration/camera/minimise.hpp"

#include <ceres/solver.h>
#include <glog/logging.h>

#include <memory>
#include <mutex>

#include "common/error.hpp"

namespace foresight {
namespace {

std::shared_ptr<ceres::ParameterBlockOrdering> ordering_of(const ceres::Problem& problem,
                                                           const std::vector<double*>& eliminated) {
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (double* block : eliminated)
    if (problem.HasParameterBlock(block)) ordering->AddElementToGroup(block, 0);
  std::vector<double*> blocks;
  problem.GetParameterBlocks(&blocks);
  for (double* block : blocks)
    if (!ordering->IsMember(block)) ordering->AddElementToGroup(block, 1);
  return ordering;
}

}  // namespace

void silence_ceres() {
  static std::once_flag once;
  std::call_once(once, [] { FLAGS_minloglevel = google::GLOG_FATAL; });
}

MinimiseSummary minimise(ceres::Problem& problem, const MinimiseOptions& options) {
  silence_ceres();
  ceres::Solver::Options ours;
  ours.linear_solver_type = options.solver;
  if (!options.eliminated.empty()) ours.linear_solver_ordering = ordering_of(problem, options.eliminated);
  ours.max_num_iterations = options.most_iterations;
  ours.function_tolerance = options.function_tolerance;
  ours.parameter_tolerance = options.parameter_tolerance;
  ours.num_threads = options.threads;
  ours.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(ours, &problem, &summary);
  return {summary.IsSolutionUsable(), summary.final_cost, summary.message};
}

double minimise_or_throw(ceres::Problem& problem, const MinimiseOptions& options, const std::string& what,
                         const std::string& cure) {
  const MinimiseSummary summary = minimise(problem, options);
  if (!summary.usable) throw RuntimeFailure(what + " does not converge (" + summary.message + ")", cure);
  return summary.cost;
}

}  // namespace foresight
