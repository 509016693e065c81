#include "calibration/camera/pose_solver.hpp"

#include <ceres/tiny_solver.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

constexpr double kDamping = 1e-6;
constexpr double kSameCost = 1e-12;  // the change of twice the cost that rounding alone makes
constexpr double kNowhere = 1e100;   // a residual that no step is taken for

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& w) {
  Eigen::Matrix3d out;
  out << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  return out;
}

/// The small motion `step` with to_motion(x + dx) = to_motion(x) to_motion(step): step = this * dx. The rotation's part
/// is the right Jacobian of SO(3).
Matrix6d own_frame_of(const Vector6d& x) {
  const Eigen::Vector3d w = x.head<3>();
  const double angle = w.norm();
  const bool small = angle < 1e-4;
  const double a = small ? 0.5 : (1 - std::cos(angle)) / (angle * angle);
  const double b = small ? 1.0 / 6 : (angle - std::sin(angle)) / (angle * angle * angle);
  const Eigen::Matrix3d W = cross_matrix(w);
  Matrix6d out = Matrix6d::Zero();
  out.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() - a * W + b * W * W;
  out.bottomRightCorner<3, 3>() = to_motion(x).linear().transpose();
  return out;
}

/// A pose problem as TinySolver wants it: as many residuals as unknowns and one more, whose Jacobian J and values f
/// have J^T J = H, J^T f = g and f^T f = 2 cost.
template <int Extra>
class Function {
 public:
  using Scalar = double;
  enum { NUM_PARAMETERS = 6 + Extra, NUM_RESIDUALS = NUM_PARAMETERS + 1 };
  using Unknowns = Eigen::Matrix<double, NUM_PARAMETERS, 1>;
  using Matrix = Eigen::Matrix<double, NUM_PARAMETERS, NUM_PARAMETERS>;
  using Residuals = Eigen::Matrix<double, NUM_RESIDUALS, 1>;
  using Jacobian = Eigen::Matrix<double, NUM_RESIDUALS, NUM_PARAMETERS>;

  Function(const PoseProblem<Extra>& problem, const PoseSolverOptions<Extra>& options)
      : problem_(problem), options_(options) {}

  PoseEstimate<Extra> at(const Unknowns& x) const {
    return {options_.base * to_motion(Vector6d(x.template head<6>())), x.template tail<Extra>()};
  }

  bool operator()(const double* parameters, double* residuals, double* jacobian) const {
    const Unknowns x = Eigen::Map<const Unknowns>(parameters);
    Eigen::Map<Residuals> f(residuals);
    f.setZero();
    if (!jacobian && ends(x)) {
      f = f_;  // TinySolver knows no step that is small enough, but ends where the cost stays the same
      return true;
    }
    PoseEquations<Extra> sum;
    if (!x.allFinite() || !problem_(at(x), jacobian != nullptr, sum)) {
      f[NUM_PARAMETERS] = kNowhere;
      if (jacobian) Eigen::Map<Jacobian>(jacobian).setZero();
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
  const PoseEquations<Extra>& equations() const { return here_; }

  /// The step that was too small to be tried; `x` where there was none.
  Unknowns with_last_step(const Unknowns& x) const { return ended_ ? last_ : x; }

 private:
  bool ends(const Unknowns& x) const {
    const Vector6d step = (x - x_).template head<6>();
    ended_ = step.dot(options_.step_metric * step) < 1;
    if (ended_) last_ = x;
    return ended_;
  }

  void write_root(const Unknowns& x, PoseEquations<Extra>& sum, Eigen::Map<Residuals> f, Eigen::Map<Jacobian> J) const {
    Matrix own = Matrix::Identity();
    own.template topLeftCorner<6, 6>() = own_frame_of(x.template head<6>());
    const Unknowns g = own.transpose() * sum.g + options_.prior * x;
    const Matrix H = own.transpose() * sum.H * own + options_.prior;
    const Eigen::LDLT<Matrix> root(H);
    const Unknowns d = root.vectorD();
    const double least = 1e-14 * std::max(d.maxCoeff(), 0.0);
    const Unknowns size = (d.array() > least).select(d.array().max(0).sqrt(), 0.0);
    const Matrix upper = root.matrixU();
    J.setZero();
    J.template topRows<NUM_PARAMETERS>() =
        size.asDiagonal() * (upper * Matrix(root.transpositionsP() * Matrix::Identity()));
    const Unknowns turned = root.matrixL().solve(Unknowns(root.transpositionsP() * g));
    for (int i = 0; i < NUM_PARAMETERS; ++i) f[i] = size[i] > 0 ? turned[i] / size[i] : 0;
    f[NUM_PARAMETERS] = std::sqrt(std::max(0.0, 2 * sum.cost - f.template head<NUM_PARAMETERS>().squaredNorm()));
    if (!options_.prior.isZero(0)) {
      const Matrix back = own.inverse();
      sum.H += back.transpose() * options_.prior * back;
      sum.g += back.transpose() * options_.prior * x;
    }
    here_ = sum, x_ = x, f_ = f;
    evaluated_ = true;
  }

  const PoseProblem<Extra>& problem_;
  const PoseSolverOptions<Extra>& options_;
  // TinySolver calls a constant function.
  mutable PoseEquations<Extra> here_;
  mutable Residuals f_ = Residuals::Zero();
  mutable Unknowns x_ = Unknowns::Zero(), last_ = Unknowns::Zero();
  mutable bool evaluated_ = false, ended_ = false;
};

}  // namespace

template <int Extra>
PoseSolution<Extra> solve_pose(const PoseEstimate<Extra>& start, const PoseProblem<Extra>& problem,
                               const PoseSolverOptions<Extra>& options) {
  using Problem = Function<Extra>;
  const Problem function(problem, options);
  typename Problem::Unknowns x;
  x.template head<6>() = to_twist(options.base.inverse() * start.T);
  x.template tail<Extra>() = start.extra;
  ceres::TinySolver<Problem> solver;
  solver.options.max_num_iterations = options.most_iterations + 1;  // it counts from one
  solver.options.initial_trust_region_radius = 1 / kDamping;
  solver.options.parameter_tolerance = 0;
  solver.options.function_tolerance = kSameCost;
  solver.Solve(function, &x);
  if (!function.evaluated()) return {start, {}, false};
  return {function.at(function.with_last_step(x)), function.equations(), true};
}

template PoseSolution<0> solve_pose(const PoseEstimate<0>&, const PoseProblem<0>&, const PoseSolverOptions<0>&);
template PoseSolution<2> solve_pose(const PoseEstimate<2>&, const PoseProblem<2>&, const PoseSolverOptions<2>&);

}  // namespace foresight
