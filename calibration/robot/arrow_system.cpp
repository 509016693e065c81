#include "calibration/robot/arrow_system.hpp"

#include <ceres/crs_matrix.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "common/error.hpp"

namespace foresight {
namespace {

// J^T J, dense; the rows of J are short.
Eigen::MatrixXd normal_matrix(const ceres::CRSMatrix& J) {
  Eigen::MatrixXd N = Eigen::MatrixXd::Zero(J.num_cols, J.num_cols);
  for (int row = 0; row < J.num_rows; ++row) {
    const auto first = static_cast<std::size_t>(J.rows[static_cast<std::size_t>(row)]);
    const auto end = static_cast<std::size_t>(J.rows[static_cast<std::size_t>(row) + 1]);
    for (std::size_t a = first; a < end; ++a)
      for (std::size_t b = first; b <= a; ++b) N(J.cols[a], J.cols[b]) += J.values[a] * J.values[b];
  }
  return N.selfadjointView<Eigen::Lower>();
}

}  // namespace

Eigen::MatrixXd invert_information(const Eigen::MatrixXd& information, std::vector<Eigen::VectorXd>& open,
                                   double tolerance) {
  const Eigen::Index n = information.rows();
  Eigen::VectorXd scale(n);
  for (Eigen::Index i = 0; i < n; ++i) scale[i] = information(i, i) > 0 ? 1 / std::sqrt(information(i, i)) : 1;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * information * scale.asDiagonal());
  Eigen::VectorXd inverse = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (eigen.eigenvalues()[i] > tolerance)
      inverse[i] = 1 / eigen.eigenvalues()[i];
    else
      open.push_back((scale.asDiagonal() * eigen.eigenvectors().col(i)).normalized());
  }
  const Eigen::MatrixXd V = scale.asDiagonal() * eigen.eigenvectors();
  return V * inverse.asDiagonal() * V.transpose();
}

ArrowSystem arrow_system(ceres::Problem& problem, const std::vector<double*>& shared, const std::vector<double*>& own) {
  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks = shared;
  options.parameter_blocks.insert(options.parameter_blocks.end(), own.begin(), own.end());
  options.apply_loss_function = true;
  ceres::CRSMatrix J;
  if (!problem.Evaluate(options, nullptr, nullptr, nullptr, &J))
    throw RuntimeFailure("the residuals cannot be evaluated at the solution", "report this with the data");
  const Eigen::MatrixXd N = normal_matrix(J);
  Eigen::Index width = 0;
  for (double* block : shared) width += problem.ParameterBlockTangentSize(block);

  ArrowSystem out;
  out.shared_information = N.topLeftCorner(width, width);
  std::vector<Eigen::MatrixXd> inverse, coupled;
  Eigen::Index at = width;
  for (double* block : own) {
    const Eigen::Index size = problem.ParameterBlockTangentSize(block);
    const Eigen::MatrixXd C = N.block(at, at, size, size);
    inverse.push_back(C.ldlt().solve(Eigen::MatrixXd::Identity(size, size)));
    coupled.push_back(N.block(0, at, width, size) * inverse.back());
    out.shared_information -= coupled.back() * N.block(at, 0, size, width);
    at += size;
  }
  out.shared_covariance = invert_information(out.shared_information, out.open);
  for (std::size_t i = 0; i < own.size(); ++i) {
    out.own_covariance.push_back(inverse[i] + coupled[i].transpose() * out.shared_covariance * coupled[i]);
    out.own_alone.push_back(inverse[i]);
    out.own_by_shared.emplace_back(-coupled[i].transpose());
  }
  return out;
}

}  // namespace foresight
