#include "calibration/robot/hand_eye_problem.hpp"

#include <ceres/autodiff_cost_function.h>
#include <ceres/problem.h>
#include <ceres/rotation.h>

#include "calibration/camera/lens_slopes.hpp"
#include "calibration/camera/minimise.hpp"
#include "calibration/robot/arrow_system.hpp"
#include "calibration/robot/hand_eye_start.hpp"
#include "common/error.hpp"

namespace foresight {
namespace {

// Noises below these change no result; a robot without any would weigh so much that the Schur complement has no digits
// left.
constexpr double kLeastRad = 1e-5, kLeastM = 1e-5, kLeastPx = 1e-4;

// Board to camera through X, Y and a robot pose with its correction (rotation vector, shift).
template <typename T>
Eigen::Matrix<T, 3, 1> to_camera(CameraMount mount, const Pose& T_base_flange, const T* X, const T* Y, const T* step,
                                 const T* scale, const Eigen::Vector3d& p_board) {
  const Eigen::Matrix<T, 3, 1> p = p_board.cast<T>() * scale[0];
  const Eigen::Matrix<T, 3, 1> q = transform(Y, p);
  const Eigen::Map<const Eigen::Matrix<T, 3, 1>> shift(step + 3);
  Eigen::Matrix<T, 3, 1> out;
  if (mount == CameraMount::fixed) {
    ceres::AngleAxisRotatePoint(step, q.data(), out.data());
    out = T_base_flange.linear().cast<T>() * (out + shift) + T_base_flange.translation().cast<T>();
  } else {
    const Eigen::Matrix<T, 3, 1> flange =
        T_base_flange.linear().transpose().cast<T>() * (q - T_base_flange.translation().cast<T>()) - shift;
    const T back[3] = {-step[0], -step[1], -step[2]};
    ceres::AngleAxisRotatePoint(back, flange.data(), out.data());
  }
  return inverse_transform(X, out);
}

struct CornerResidual {
  CameraMount mount;
  Distortion distortion;
  const Pose& T_base_flange;
  Eigen::Vector3d p_board;
  Eigen::Vector2d pixel;
  double weight;

  template <typename T>
  bool operator()(const T* lens, const T* X, const T* Y, const T* step, const T* scale, T* residual) const {
    Eigen::Matrix<T, 2, 1> predicted;
    const Eigen::Matrix<T, 3, 1> p = to_camera(mount, T_base_flange, X, Y, step, scale, p_board);
    if (!project_by_slopes(distortion, lens, p, predicted)) return false;
    for (int i = 0; i < 2; ++i) residual[i] = (predicted[i] - T(pixel[i])) * T(weight);
    return true;
  }
};

struct ScaleResidual {
  double weight;

  template <typename T>
  bool operator()(const T* scale, T* residual) const {
    residual[0] = (scale[0] - T(1)) * T(weight);
    return true;
  }
};

// (correction - offsets through the joints) over the noise of the robot: linear.
class RobotResidual : public ceres::CostFunction {
 public:
  RobotResidual(const Vector6d& weight, const Eigen::MatrixXd& per_joint) : weight_(weight), per_joint_(per_joint) {
    set_num_residuals(6);
    mutable_parameter_block_sizes()->push_back(6);
    if (per_joint.cols() > 0) mutable_parameter_block_sizes()->push_back(static_cast<int>(per_joint.cols()));
  }

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    Eigen::Map<Vector6d> r(residuals);
    r = Eigen::Map<const Vector6d>(parameters[0]);
    if (per_joint_.cols() > 0) r -= per_joint_ * Eigen::Map<const Eigen::VectorXd>(parameters[1], per_joint_.cols());
    r = r.cwiseProduct(weight_);
    if (jacobians == nullptr) return true;
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    if (jacobians[0] != nullptr) Eigen::Map<RowMajor>(jacobians[0], 6, 6) = weight_.asDiagonal();
    if (per_joint_.cols() > 0 && jacobians[1] != nullptr)
      Eigen::Map<RowMajor>(jacobians[1], 6, per_joint_.cols()) = -(weight_.asDiagonal() * per_joint_);
    return true;
  }

 private:
  Vector6d weight_;
  Eigen::MatrixXd per_joint_;
};

// (offsets - means) over one sigma: what is known of the joints' zeros without any image.
class OffsetResidual : public ceres::CostFunction {
 public:
  OffsetResidual(std::vector<double> means, double sigma) : means_(std::move(means)), weight_(1 / sigma) {
    set_num_residuals(static_cast<int>(means_.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(means_.size()));
  }

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const std::size_t n = means_.size();
    for (std::size_t i = 0; i < n; ++i) residuals[i] = weight_ * (parameters[0][i] - means_[i]);
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    for (std::size_t i = 0; i < n * n; ++i) jacobians[0][i] = i % (n + 1) == 0 ? weight_ : 0;
    return true;
  }

 private:
  std::vector<double> means_;
  double weight_;
};

double typical_sigma(const CornerSet& corners) {
  std::vector<double> sigmas;
  for (const BoardView& view : corners.views)
    for (const Corner& corner : view.corners) sigmas.push_back(corner.sigma_px);
  return median(std::move(sigmas));
}

struct Adjustment {
  ceres::Problem problem;
  std::vector<double*> shared, own;
  std::vector<std::size_t> views;  // of `own`
  int corner_rows = 0;
};

void hold_unused_lens(ceres::Problem& problem, HandEyeState& state) {
  if (state.camera_held) return problem.SetParameterBlockConstant(state.camera.lens.data());
  std::vector<int> held;
  const std::vector<int> freed = free_parameters(state.camera.distortion);
  for (int i = 0; i < kLensParameters; ++i)
    if (std::find(freed.begin(), freed.end(), i) == freed.end()) held.push_back(i);
  if (!held.empty()) problem.SetManifold(state.camera.lens.data(), new ceres::SubsetManifold(kLensParameters, held));
}

void add_view(const HandEyeData& data, const HandEyeSelection& selection, std::size_t v, double typical_px,
              HandEyeState& state, Adjustment& out) {
  using Cost = ceres::AutoDiffCostFunction<CornerResidual, 2, kLensParameters, 7, 7, 6, 1>;
  double* step = state.corrections[v].data();
  const BoardView& view = data.corners.views[v];
  for (std::size_t c = 0; c < view.corners.size(); ++c) {
    if (!selection.keep[v][c]) continue;
    const Corner& corner = view.corners[c];
    auto* functor = new CornerResidual{state.mount,
                                       state.camera.distortion,
                                       data.poses[v].T_base_flange,
                                       data.corners.p_board[static_cast<std::size_t>(corner.index)],
                                       corner.pixel,
                                       typical_px / corner.sigma_px / state.sigma_px};
    out.problem.AddResidualBlock(new Cost(functor), nullptr, state.camera.lens.data(), state.X.data(), state.Y.data(),
                                 step, &state.board_scale);
    out.corner_rows += 2;
  }
  Vector6d weight;
  weight << Eigen::Vector3d::Constant(1 / state.sigma_rad), Eigen::Vector3d::Constant(1 / state.sigma_m);
  if (!state.trust.empty()) weight *= std::sqrt(state.trust[v]);
  auto* prior = new RobotResidual(weight, data.poses[v].flange_per_joint);
  if (state.joint_offsets.empty())
    out.problem.AddResidualBlock(prior, nullptr, step);
  else
    out.problem.AddResidualBlock(prior, nullptr, step, state.joint_offsets.data());
  out.own.push_back(step);
  out.views.push_back(v);
}

void build(const HandEyeData& data, const HandEyeSelection& selection, HandEyeState& state, Adjustment& out) {
  const double typical_px = typical_sigma(data.corners);
  out.shared = {state.X.data(), state.Y.data()};
  for (std::size_t v = 0; v < data.poses.size(); ++v)
    if (selection.used[v]) add_view(data, selection, v, typical_px, state, out);
  out.problem.SetManifold(state.X.data(), motion_manifold());
  out.problem.SetManifold(state.Y.data(), motion_manifold());
  hold_unused_lens(out.problem, state);
  if (state.board_sigma > 0) {
    auto* functor = new ScaleResidual{1 / state.board_sigma};
    out.problem.AddResidualBlock(new ceres::AutoDiffCostFunction<ScaleResidual, 1, 1>(functor), nullptr,
                                 &state.board_scale);
    out.shared.push_back(&state.board_scale);
  } else {
    out.problem.SetParameterBlockConstant(&state.board_scale);
  }
  if (!state.camera_held) out.shared.push_back(state.camera.lens.data());
  if (state.joint_offsets.empty()) return;
  out.problem.AddResidualBlock(new OffsetResidual(state.joint_means, state.joint_sigma), nullptr,
                               state.joint_offsets.data());
  out.shared.push_back(state.joint_offsets.data());
}

void minimise(Adjustment& adjustment) {
  MinimiseOptions options;
  options.solver = ceres::SPARSE_SCHUR;
  options.eliminated = adjustment.own;
  options.parameter_tolerance = 1e-12;
  options.threads = 2;
  minimise_or_throw(adjustment.problem, options, "the hand-eye adjustment",
                    "check that the poses belong to the images and that their unit is the metre");
}

/// Of what is the robot's in the correction of adjustment's i-th view: the joints' offsets are not, however little the
/// views say of them.
Matrix6d robot_covariance(const ArrowSystem& system, std::size_t i, const RobotPose& robot) {
  Eigen::MatrixXd by_shared = system.own_by_shared[i];
  if (robot.flange_per_joint.cols() > 0)
    by_shared.rightCols(robot.flange_per_joint.cols()) -= robot.flange_per_joint;  // the offsets come last
  return system.own_alone[i] + by_shared * system.shared_covariance * by_shared.transpose();
}

// Helmert: each noise is scaled by its squared residuals over its redundancy.
void update_noise(const ArrowSystem& system, const Adjustment& adjustment, const HandEyeData& data, double corner_sum,
                  HandEyeState& state) {
  double turn = 0, shift = 0, turn_known = 0, shift_known = 0;
  for (std::size_t i = 0; i < adjustment.views.size(); ++i) {
    const std::size_t v = adjustment.views[i];
    const Vector6d left =
        Eigen::Map<const Vector6d>(state.corrections[v].data()) - joint_correction(state, data.poses[v]);
    const double trust = state.trust.empty() ? 1 : state.trust[v];
    turn += trust * left.head<3>().squaredNorm();
    shift += trust * left.tail<3>().squaredNorm();
    const Matrix6d known = robot_covariance(system, i, data.poses[v]);
    turn_known += trust * known.topLeftCorner<3, 3>().trace() / (state.sigma_rad * state.sigma_rad);
    shift_known += trust * known.bottomRightCorner<3, 3>().trace() / (state.sigma_m * state.sigma_m);
  }
  const double terms = 3 * static_cast<double>(adjustment.views.size());
  const double parameters = 2 * terms + static_cast<double>(system.shared_information.rows());
  const double corner_redundancy = adjustment.corner_rows - (parameters - turn_known - shift_known);
  // The posterior's spread is part of the noise (expectation step) where little redundancy is left.
  const auto next = [&](double sum, double known, double sigma, double least) {
    const double redundancy = terms - known;
    const double helmert = redundancy > 0.5 ? sum / redundancy : 0;
    const double expected = (sum + known * sigma * sigma) / terms;
    return std::max(least, std::sqrt(redundancy > 0.2 * terms ? helmert : expected));
  };
  state.sigma_rad = next(turn, turn_known, state.sigma_rad, kLeastRad);
  state.sigma_m = next(shift, shift_known, state.sigma_m, kLeastM);
  state.sigma_px = std::max(kLeastPx, state.sigma_px * std::sqrt(corner_sum / std::max(1.0, corner_redundancy)));
}

// Expectation step of Student's t: D. Lange, R. Little, J. Taylor, Robust statistical modeling using the t
// distribution, JASA 84, 1989, for six coordinates.
void update_trust(const ArrowSystem& system, const Adjustment& adjustment, const HandEyeData& data,
                  HandEyeState& state) {
  if (state.robot_freedom <= 0) return;
  state.trust.resize(data.poses.size(), 1.0);
  const double turn = 1 / (state.sigma_rad * state.sigma_rad), shift = 1 / (state.sigma_m * state.sigma_m);
  for (std::size_t i = 0; i < adjustment.views.size(); ++i) {
    const std::size_t v = adjustment.views[i];
    const Vector6d left =
        Eigen::Map<const Vector6d>(state.corrections[v].data()) - joint_correction(state, data.poses[v]);
    const Matrix6d known = robot_covariance(system, i, data.poses[v]);
    const double distance = turn * (left.head<3>().squaredNorm() + known.topLeftCorner<3, 3>().trace()) +
                            shift * (left.tail<3>().squaredNorm() + known.bottomRightCorner<3, 3>().trace());
    state.trust[v] = (state.robot_freedom + 6) / (state.robot_freedom + distance);
  }
}

double corner_cost(const Adjustment& adjustment, const HandEyeData& data, const HandEyeSelection& selection,
                   const HandEyeState& state) {
  const double typical = typical_sigma(data.corners);
  double sum = 0;
  for (const std::size_t v : adjustment.views) {
    const Vector6d step = Eigen::Map<const Vector6d>(state.corrections[v].data());
    const BoardView& view = data.corners.views[v];
    for (std::size_t c = 0; c < view.corners.size(); ++c) {
      if (!selection.keep[v][c]) continue;
      const Corner& corner = view.corners[c];
      const Eigen::Vector2d off =
          predicted_pixel(state, data.poses[v], step, data.corners.p_board[static_cast<std::size_t>(corner.index)]) -
          corner.pixel;
      sum += (off * typical / corner.sigma_px / state.sigma_px).squaredNorm();
    }
  }
  return sum;
}

HandEyeCovariance covariance_of(const ArrowSystem& system, const HandEyeState& state) {
  HandEyeCovariance out;
  const Eigen::VectorXd sigma = system.shared_covariance.diagonal().cwiseMax(0).cwiseSqrt();
  const auto motion = [&](int block) {
    Vector6d s = sigma.segment<6>(6 * block);
    s.head<3>() *= 2;  // Eigen's quaternion manifold steps by half angles
    return s;
  };
  out.X_sigma = motion(0);
  out.Y_sigma = motion(1);
  Eigen::Index at = 12;
  if (state.board_sigma > 0) out.board_scale_sigma = sigma[at++];
  if (!state.camera_held)
    for (const int i : free_parameters(state.camera.distortion))
      out.lens_sigma[static_cast<std::size_t>(i)] = sigma[at++];
  for (std::size_t j = 0; j < state.joint_offsets.size(); ++j) out.joint_offset_sigma.push_back(sigma[at++]);
  out.corrections = system.own_covariance;
  out.open = static_cast<int>(system.open.size());
  return out;
}

}  // namespace

void adjust(const HandEyeData& data, const HandEyeSelection& selection, int noise_rounds, HandEyeState& state,
            HandEyeCovariance* covariance) {
  for (int round = 0;; ++round) {
    Adjustment adjustment;
    build(data, selection, state, adjustment);
    minimise(adjustment);
    const bool last = round == noise_rounds;
    if (last && covariance == nullptr) return;
    const ArrowSystem system = arrow_system(adjustment.problem, adjustment.shared, adjustment.own);
    if (covariance != nullptr) *covariance = covariance_of(system, state);
    if (last) return;
    const HandEyeState before = state;
    update_noise(system, adjustment, data, corner_cost(adjustment, data, selection, state), state);
    update_trust(system, adjustment, data, state);
    const auto settled = [](double a, double b) { return std::abs(a - b) < 1e-3 * a; };
    bool alike = before.trust.size() == state.trust.size();
    for (std::size_t v = 0; alike && v < state.trust.size(); ++v)
      alike = std::abs(before.trust[v] - state.trust[v]) < 0.01;
    if (alike && settled(before.sigma_px, state.sigma_px) && settled(before.sigma_rad, state.sigma_rad) &&
        settled(before.sigma_m, state.sigma_m))
      return;
  }
}

Eigen::Vector3d scaled_point(const HandEyeState& state, const Eigen::Vector3d& p_board) {
  return state.board_scale * p_board;
}

Eigen::Vector2d predicted_pixel(const HandEyeState& state, const RobotPose& robot, const Vector6d& correction,
                                const Eigen::Vector3d& p_board) {
  Eigen::Vector2d pixel(1e6, 1e6);
  const Eigen::Vector3d p = to_camera<double>(state.mount, robot.T_base_flange, state.X.data(), state.Y.data(),
                                              correction.data(), &state.board_scale, p_board);
  project<double>(state.camera.distortion, state.camera.lens.data(), p, pixel);
  return pixel;
}

Vector6d joint_correction(const HandEyeState& state, const RobotPose& robot) {
  if (state.joint_offsets.empty()) return Vector6d::Zero();
  return robot.flange_per_joint *
         Eigen::Map<const Eigen::VectorXd>(state.joint_offsets.data(), robot.flange_per_joint.cols());
}

}  // namespace foresight
