#include "calibration/camera/rig_solver.hpp"

#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <limits>
#include <tuple>

#include "calibration/camera/corner_residual.hpp"
#include "calibration/camera/rigid_motion.hpp"
#include "common/error.hpp"
#include "common/statistics.hpp"

namespace foresight {
namespace {

using Accepted = std::vector<std::array<std::vector<char>, 2>>;

template <typename Visit>
void for_each_corner(const RigViews& views, const Visit& visit) {
  for (std::size_t v = 0; v < views.views.size(); ++v)
    for (int c = 0; c < views.cameras; ++c) {
      const auto& corners = views.views[v].corners[static_cast<std::size_t>(c)];
      for (std::size_t i = 0; i < corners.size(); ++i) visit(v, static_cast<std::size_t>(c), i, corners[i]);
    }
}

double median_sigma(const RigViews& views) {
  std::vector<double> sigmas;
  for_each_corner(views, [&](auto, auto, auto, const Corner& corner) { sigmas.push_back(corner.sigma_px); });
  return median(std::move(sigmas));
}

Accepted accepted_corners(const RigViews& views, const std::vector<RejectedCorner>& rejected) {
  Accepted accepted(views.views.size());
  for (std::size_t v = 0; v < accepted.size(); ++v)
    for (std::size_t c = 0; c < 2; ++c) accepted[v][c].assign(views.views[v].corners[c].size(), 1);
  for (const RejectedCorner& r : rejected) {
    const auto c = static_cast<std::size_t>(r.camera);
    const auto& corners = views.views[r.view].corners[c];
    for (std::size_t i = 0; i < corners.size(); ++i)
      if (corners[i].index == r.index) accepted[r.view][c][i] = 0;
  }
  return accepted;
}

/// The Ceres problem over copies of the parameters.
class Bundle {
 public:
  /// `loss_px`: where corners begin to pull less, 0: nowhere.
  Bundle(const RigViews& views, const RigSolution& start, const Accepted& accepted, bool warp, double loss_px)
      : views_(views), start_(start), loss_(loss_px > 0 ? new ceres::CauchyLoss(loss_px) : nullptr) {
    for (const CameraModel& camera : start.rig.cameras) lenses_.push_back(camera.lens);
    T_left_right_ = to_parameters(start.rig.T_left_right);
    warp_ = {start.rig.warp.x_m, start.rig.warp.y_m};
    for (const Pose& T : start.T_left_board) poses_.push_back(to_parameters(T));
    add_parameters(warp);
    add_residuals(accepted);
  }

  bool solve(int most_iterations) {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_SCHUR;
    options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (auto& pose : poses_) options.linear_solver_ordering->AddElementToGroup(pose.data(), 0);
    for (double* block : shared_) options.linear_solver_ordering->AddElementToGroup(block, 1);
    options.max_num_iterations = most_iterations;
    options.max_trust_region_radius = 1e9;  // weak parameters would make the reduced system singular
    options.function_tolerance = 1e-9;
    options.parameter_tolerance = 1e-10;
    options.gradient_tolerance = 1e-14;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    if (summary.termination_type == ceres::FAILURE)
      throw InputError("calibration", "the start of the solution puts a board behind a camera",
                       "check that --board names the board that was shown");
    return summary.termination_type == ceres::CONVERGENCE;
  }

  void store(RigSolution& solution) const {
    solution.rig = start_.rig;
    for (std::size_t c = 0; c < lenses_.size(); ++c) solution.rig.cameras[c].lens = lenses_[c];
    solution.rig.T_left_right = to_pose(T_left_right_);
    solution.rig.warp = {warp_[0], warp_[1]};
    solution.T_left_board.clear();
    for (const auto& pose : poses_) solution.T_left_board.push_back(to_pose(pose));
  }

  RigInformation information() {
    RigInformation info;
    ceres::Problem::EvaluateOptions options;
    int at = 0;
    const auto add = [&](double* block) {
      options.parameter_blocks.push_back(block);
      const int here = at;
      at += problem_.ParameterBlockTangentSize(block);
      return here;
    };
    for (std::size_t c = 0; c < lenses_.size(); ++c) info.lens_at[c] = add(lenses_[c].data());
    if (views_.cameras == 2) info.motion_at = add(T_left_right_.data());
    if (!problem_.IsParameterBlockConstant(warp_.data())) info.warp_at = add(warp_.data());
    info.poses_at = at;
    for (auto& pose : poses_) add(pose.data());
    ceres::CRSMatrix crs;
    problem_.Evaluate(options, nullptr, nullptr, nullptr, &crs);
    const Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>> J(
        crs.num_rows, crs.num_cols, static_cast<Eigen::Index>(crs.values.size()), crs.rows.data(), crs.cols.data(),
        crs.values.data());
    const Eigen::SparseMatrix<double> columns = J;
    info.matrix = columns.transpose() * columns;
    return info;
  }

 private:
  void add_parameters(bool warp) {
    for (std::size_t c = 0; c < lenses_.size(); ++c) {
      const auto free = free_parameters(start_.rig.cameras[c].distortion);
      std::vector<int> fixed;
      for (int i = 0; i < kLensParameters; ++i)
        if (std::find(free.begin(), free.end(), i) == free.end()) fixed.push_back(i);
      auto* manifold = fixed.empty() ? nullptr : new ceres::SubsetManifold(kLensParameters, fixed);
      problem_.AddParameterBlock(lenses_[c].data(), kLensParameters, manifold);
      shared_.push_back(lenses_[c].data());
    }
    if (views_.cameras == 2) {
      problem_.AddParameterBlock(T_left_right_.data(), 7, motion_manifold());
      shared_.push_back(T_left_right_.data());
    }
    problem_.AddParameterBlock(warp_.data(), 2);
    shared_.push_back(warp_.data());
    if (!warp) problem_.SetParameterBlockConstant(warp_.data());
    for (auto& pose : poses_) problem_.AddParameterBlock(pose.data(), 7, motion_manifold());
  }

  void add_residuals(const Accepted& accepted) {
    const auto weights = warp_weights(views_.p_board);
    const double sigma = median_sigma(views_);
    for_each_corner(views_, [&](std::size_t v, std::size_t c, std::size_t i, const Corner& corner) {
      if (!accepted[v][c][i]) return;
      const auto index = static_cast<std::size_t>(corner.index);
      auto* cost = corner_cost({start_.rig.cameras[c].distortion, views_.p_board[index], weights[index], corner.pixel,
                                sigma / corner.sigma_px, c == 1});
      if (c == 0)
        problem_.AddResidualBlock(cost, loss_, lenses_[0].data(), poses_[v].data(), warp_.data());
      else
        problem_.AddResidualBlock(cost, loss_, lenses_[1].data(), poses_[v].data(), warp_.data(), T_left_right_.data());
    });
  }

  const RigViews& views_;
  const RigSolution& start_;
  ceres::LossFunction* loss_;
  std::vector<LensParameters> lenses_;
  MotionParameters T_left_right_{};
  std::array<double, 2> warp_{};
  std::vector<MotionParameters> poses_;
  std::vector<double*> shared_;
  ceres::Problem problem_;
};

// Of a coordinate of a corner of median sigma_px, by the median of all errors.
double robust_noise(const RigViews& views, const RigErrors& errors) {
  const double sigma = median_sigma(views);
  std::vector<double> lengths;
  for_each_corner(views, [&](std::size_t v, std::size_t c, std::size_t i, const Corner& corner) {
    lengths.push_back(errors[v][c][i].norm() * sigma / corner.sigma_px);
  });
  return robust_sigma_of_lengths(std::move(lengths));
}

// Sorted by size, largest first.
std::vector<RejectedCorner> outliers(const RigViews& views, const RigErrors& errors, double reject_sigmas) {
  const OutlierBound bound = outlier_bound(views, errors, reject_sigmas);
  std::vector<RejectedCorner> found;
  for_each_corner(views, [&](std::size_t v, std::size_t c, std::size_t i, const Corner& corner) {
    const double error = errors[v][c][i].norm();
    if (!(bound.weighted_px(corner, error) <= bound.px)) found.push_back({v, static_cast<int>(c), corner.index, error});
  });
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.error_px > b.error_px; });
  return found;
}

bool same_corners(const std::vector<RejectedCorner>& a, const std::vector<RejectedCorner>& b) {
  if (a.size() != b.size()) return false;
  const auto key = [](const RejectedCorner& r) { return std::tuple(r.view, r.camera, r.index); };
  std::vector<std::tuple<std::size_t, int, int>> ka, kb;
  for (const auto& r : a) ka.push_back(key(r));
  for (const auto& r : b) kb.push_back(key(r));
  std::sort(ka.begin(), ka.end());
  std::sort(kb.begin(), kb.end());
  return ka == kb;
}

void count_residuals(const RigViews& views, const Accepted& accepted, bool warp, RigSolution& solution) {
  const RigErrors errors = rig_errors(views, solution);
  const double sigma = median_sigma(views);
  double sum = 0, weighted = 0;
  solution.points = 0;
  for_each_corner(views, [&](std::size_t v, std::size_t c, std::size_t i, const Corner& corner) {
    if (!accepted[v][c][i]) return;
    const double square = errors[v][c][i].squaredNorm();
    sum += square;
    weighted += square * sigma * sigma / (corner.sigma_px * corner.sigma_px);
    ++solution.points;
  });
  solution.parameters = static_cast<int>(6 * views.views.size()) + (warp ? 2 : 0) + (views.cameras == 2 ? 6 : 0);
  for (const CameraModel& camera : solution.rig.cameras)
    solution.parameters += static_cast<int>(free_parameters(camera.distortion).size());
  solution.rms_px = std::sqrt(sum / std::max(1, solution.points));
  solution.noise_px = std::sqrt(weighted / std::max(1, 2 * solution.points - solution.parameters));
}

}  // namespace

OutlierBound outlier_bound(const RigViews& views, const RigErrors& errors, double reject_sigmas) {
  constexpr double kLeast = 0.02;  // px: in drawn images all errors are smaller, and none of them is a mistake
  return {std::max(kLeast, reject_sigmas * robust_noise(views, errors)), median_sigma(views)};
}

RigErrors rig_errors(const RigViews& views, const RigSolution& solution) {
  RigErrors errors(views.views.size());
  const auto points = warped(views.p_board, solution.rig.warp);
  for_each_corner(views, [&](std::size_t v, std::size_t c, std::size_t, const Corner& corner) {
    const Eigen::Vector3d p_left = solution.T_left_board[v] * points[static_cast<std::size_t>(corner.index)];
    const auto pixel = project(solution.rig.cameras[c], to_camera(solution.rig, static_cast<int>(c), p_left));
    errors[v][c].push_back(pixel ? Eigen::Vector2d(*pixel - corner.pixel)
                                 : Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity()));
  });
  return errors;
}

RigSolution solve_rig(const RigViews& views, const RigSolution& start, const RigSolverOptions& options) {
  RigSolution solution = start;
  for (int round = 0; round < options.most_rounds; ++round) {
    const Accepted accepted = accepted_corners(views, solution.rejected);
    const RigSolution from = solution;
    const double loss_px = from.points > 0 ? options.loss_sigmas * robust_noise(views, rig_errors(views, from)) : 0;
    Bundle bundle(views, from, accepted, options.warp, loss_px);
    solution.converged = bundle.solve(options.most_iterations);
    bundle.store(solution);
    count_residuals(views, accepted, options.warp, solution);
    auto found = outliers(views, rig_errors(views, solution), options.reject_sigmas);
    const bool same = same_corners(found, solution.rejected);
    solution.rejected = same ? std::move(found) : solution.rejected;
    if (same && round > 0) break;
    if (round + 1 < options.most_rounds) solution.rejected = std::move(found);
  }
  return solution;
}

RigSolution subset(const RigSolution& all, const std::vector<std::size_t>& indices) {
  RigSolution some = all;
  some.rejected.clear();
  some.T_left_board.clear();
  for (const std::size_t v : indices) some.T_left_board.push_back(all.T_left_board[v]);
  return some;
}

RigInformation rig_information(const RigViews& views, const RigSolution& solution, bool warp) {
  return Bundle(views, solution, accepted_corners(views, solution.rejected), warp, 0).information();
}

}  // namespace foresight
