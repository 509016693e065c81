#include "calibration/camera/pose_solver.hpp"

#include <ceres/tiny_solver.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>

#include "common/rotation.hpp"

namespace foresight {
namespace {

constexpr double kDamping = 1e-6;
constexpr double kSameCost = 1e-12;  // the change of twice the cost that rounding alone makes
constexpr double kNowhere = 1e100;   // a residual that no step is taken for

constexpr int kSize = 8;  // of every problem: one size is compiled, and numbers that a problem does not have stay zero
using Unknowns = Eigen::Matrix<double, kSize, 1>;
using Matrix = Eigen::Matrix<double, kSize, kSize>;
using Equations = PoseEquations<kSize - 6>;
using Estimate = PoseEstimate<kSize - 6>;
using Problem = PoseProblem<kSize - 6>;
using Options = PoseSolverOptions<kSize - 6>;

/// The small motion `step` with to_motion(x + dx) = to_motion(x) to_motion(step): step = (turn dw, shift dt).
struct OwnFrame {
  Eigen::Matrix3d turn;   // the right Jacobian of SO(3)
  Eigen::Matrix3d shift;  // a rotation

  explicit OwnFrame(const Vector6d& x) : shift(to_motion(x).linear().transpose()) {
    const Eigen::Vector3d w = x.head<3>();
    const double angle = w.norm();
    const bool small = angle < 1e-4;
    const double a = small ? 0.5 : (1 - std::cos(angle)) / (angle * angle);
    const double b = small ? 1.0 / 6 : (angle - std::sin(angle)) / (angle * angle * angle);
    const Eigen::Matrix3d W = cross_matrix(w);
    turn = Eigen::Matrix3d::Identity() - a * W + b * W * W;
  }
};

/// Equations of u become those of v, where the first three of u are `turn` times those of v, the next three `shift`.
void substitute(const Eigen::Matrix3d& turn, const Eigen::Matrix3d& shift, Matrix& H, Unknowns& g) {
  H.topRows<3>() = (turn.transpose() * H.topRows<3>()).eval();
  H.middleRows<3>(3) = (shift.transpose() * H.middleRows<3>(3)).eval();
  H.leftCols<3>() = (H.leftCols<3>() * turn).eval();
  H.middleCols<3>(3) = (H.middleCols<3>(3) * shift).eval();
  g.head<3>() = (turn.transpose() * g.head<3>()).eval();
  g.segment<3>(3) = (shift.transpose() * g.segment<3>(3)).eval();
}

/// A pose problem as TinySolver wants it: as many residuals as unknowns and one more, whose Jacobian J and values f
/// have J^T J = H, J^T f = g and f^T f = 2 cost.
class Function {
 public:
  using Scalar = double;
  enum { NUM_PARAMETERS = kSize, NUM_RESIDUALS = kSize + 1 };
  using Residuals = Eigen::Matrix<double, NUM_RESIDUALS, 1>;
  using Jacobian = Eigen::Matrix<double, NUM_RESIDUALS, NUM_PARAMETERS>;

  Function(const Problem& problem, const Options& options) : problem_(problem), options_(options) {}

  Estimate at(const Unknowns& x) const {
    return {options_.base * to_motion(Vector6d(x.head<6>())), x.tail<kSize - 6>()};
  }

  bool operator()(const double* parameters, double* residuals, double* jacobian) const {
    const Unknowns x = Eigen::Map<const Unknowns>(parameters);
    Eigen::Map<Residuals> f(residuals);
    f.setZero();
    if (!jacobian && ends(x)) {
      f = f_;  // TinySolver knows no step that is small enough, but ends where the cost stays the same
      return true;
    }
    Equations sum;
    if (!x.allFinite() || !problem_(at(x), jacobian != nullptr, sum)) {
      f[NUM_PARAMETERS] = kNowhere;
      if (jacobian) Eigen::Map<Jacobian>(jacobian).setZero(), silent_ = x;
      return false;
    }
    sum.cost += 0.5 * x.dot(options_.prior * x);
    if (jacobian)
      write_root(x, sum, f, Eigen::Map<Jacobian>(jacobian));
    else
      f[NUM_PARAMETERS] = std::sqrt(2 * sum.cost);
    return true;
  }

  bool evaluated() const { return evaluated_; }
  const Equations& equations() const { return here_; }

  /// The step that was too small to be tried; `x` where there was none.
  Unknowns with_last_step(const Unknowns& x) const { return ended_ ? last_ : x; }

 private:
  bool ends(const Unknowns& x) const {
    const Vector6d step = (x - x_).head<6>();
    ended_ = silent_ || step.dot(options_.step_metric * step) < 1;
    if (ended_) last_ = silent_.value_or(x);
    return ended_;
  }

  void write_root(const Unknowns& x, Equations& sum, Eigen::Map<Residuals> f, Eigen::Map<Jacobian> J) const {
    const OwnFrame own(x.head<6>());
    Matrix H = sum.H;
    Unknowns g = sum.g;
    substitute(own.turn, own.shift, H, g);
    Matrix prior_H = options_.prior;
    Unknowns prior_g = options_.prior * x;
    H += prior_H, g += prior_g;
    const Eigen::LDLT<Matrix> root(H);
    const Unknowns d = root.vectorD();
    const double least = 1e-14 * std::max(d.maxCoeff(), 0.0);
    const Unknowns size = (d.array() > least).select(d.array().max(0).sqrt(), 0.0);
    const Matrix upper = root.matrixU();
    J.setZero();
    J.topRows<kSize>() = size.asDiagonal() * (upper * Matrix(root.transpositionsP() * Matrix::Identity()));
    const Unknowns turned = root.matrixL().solve(Unknowns(root.transpositionsP() * g));
    for (int i = 0; i < NUM_PARAMETERS; ++i) f[i] = size[i] > 0 ? turned[i] / size[i] : 0;
    f[NUM_PARAMETERS] = std::sqrt(std::max(0.0, 2 * sum.cost - f.head<kSize>().squaredNorm()));
    substitute(own.turn.inverse(), own.shift.transpose(), prior_H, prior_g);
    sum.H += prior_H, sum.g += prior_g;
    here_ = sum, x_ = x, f_ = f;
    evaluated_ = true;
  }

  const Problem& problem_;
  const Options& options_;
  // TinySolver calls a constant function.
  mutable Equations here_;
  mutable Residuals f_ = Residuals::Zero();
  mutable Unknowns x_ = Unknowns::Zero(), last_ = Unknowns::Zero();
  mutable std::optional<Unknowns> silent_;  // after a step that lowered the cost, there are no derivatives
  mutable bool evaluated_ = false, ended_ = false;
};

}  // namespace

template <>
PoseSolution<2> solve_pose(const PoseEstimate<2>& start, const PoseProblem<2>& problem,
                           const PoseSolverOptions<2>& options) {
  const Function function(problem, options);
  Unknowns x;
  x.head<6>() = to_twist(options.base.inverse() * start.T);
  x.tail<2>() = start.extra;
  ceres::TinySolver<Function> solver;
  solver.options.max_num_iterations = options.most_iterations + 1;  // it counts from one
  solver.options.initial_trust_region_radius = 1 / kDamping;
  solver.options.parameter_tolerance = 0;
  solver.options.function_tolerance = kSameCost;
  solver.Solve(function, &x);
  if (!function.evaluated()) return {start, {}, false};
  return {function.at(function.with_last_step(x)), function.equations(), true};
}

template <>
PoseSolution<0> solve_pose(const PoseEstimate<0>& start, const PoseProblem<0>& problem,
                           const PoseSolverOptions<0>& options) {
  PoseSolverOptions<2> all{
      .base = options.base, .most_iterations = options.most_iterations, .step_metric = options.step_metric};
  all.prior.topLeftCorner<6, 6>() = options.prior;
  const auto with_two_more = [&](const PoseEstimate<2>& at, bool derivatives, PoseEquations<2>& sum) {
    PoseEquations<0> own;
    if (!problem({at.T, {}}, derivatives, own)) return false;
    sum.H.topLeftCorner<6, 6>() = own.H, sum.g.head<6>() = own.g, sum.cost = own.cost;
    return true;
  };
  const PoseSolution<2> found = solve_pose<2>({start.T, Eigen::Vector2d::Zero()}, with_two_more, all);
  PoseSolution<0> out{{found.at.T, {}}, {}, found.usable};
  out.equations.H = found.equations.H.topLeftCorner<6, 6>();
  out.equations.g = found.equations.g.head<6>();
  out.equations.cost = found.equations.cost;
  return out;
}

}  // namespace foresight
