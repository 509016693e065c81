#include "calibration/robot/pan_tilt_problem.hpp"

#include <ceres/autodiff_cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/rotation.h>
#include <ceres/solver.h>

#include <algorithm>
#include <utility>

#include "calibration/robot/arrow_system.hpp"
#include "common/error.hpp"

namespace foresight {
namespace {

constexpr double kRobust = 3;
constexpr std::size_t kStartSamples = 40, kStarts = 30;

template <typename T>
Eigen::Quaternion<T> turn_about(const Eigen::Vector3d& axis, const T& angle) {
  using std::cos;
  using std::sin;
  const T s = sin(angle / T(2));
  return {cos(angle / T(2)), s * axis.x(), s * axis.y(), s * axis.z()};
}

// Turn (rad) and shift (m) from the predicted to the measured camera, over their noise.
struct PanTiltResidual {
  PanTiltAngles angles;
  Eigen::Quaterniond q_measured;
  Eigen::Vector3d p_measured;
  double weight_turn, weight_shift;

  template <typename T>
  bool operator()(const T* world, const T* link, const T* camera, const T* joints, T* residual) const {
    using Vector = Eigen::Matrix<T, 3, 1>;
    using Quaternion = Eigen::Quaternion<T>;
    const T pan = joints[0] * angles.pan + joints[2] * (0.5 * angles.came[0]);
    const T tilt = joints[1] * angles.tilt + joints[3] * (0.5 * angles.came[1]);
    const Quaternion q_pan = Eigen::Map<const Quaternion>(world) * turn_about(Eigen::Vector3d::UnitZ(), pan);
    const Quaternion q_tilt =
        q_pan * (turn_about(Eigen::Vector3d::UnitX(), link[1]) * turn_about(Eigen::Vector3d::UnitZ(), tilt));
    const Vector along(link[0], T(0), T(0));
    const Vector p =
        Eigen::Map<const Vector>(world + 4) + q_pan * along + q_tilt * Vector(Eigen::Map<const Vector>(camera + 4));
    const Quaternion q = q_tilt * Eigen::Map<const Quaternion>(camera);
    const Quaternion off = q.conjugate() * q_measured.cast<T>();
    const T wxyz[4] = {off.w(), off.x(), off.y(), off.z()};
    ceres::QuaternionToAngleAxis(wxyz, residual);
    const Vector shift = q.conjugate() * Vector(p_measured.cast<T>() - p);
    for (int i = 0; i < 3; ++i) {
      residual[i] *= T(weight_turn);
      residual[3 + i] = shift[i] * T(weight_shift);
    }
    return true;
  }
};

void build(const std::vector<PanTiltSample>& samples, PanTiltState& state, int left_out, bool turns_only,
           ceres::Problem& problem) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (static_cast<int>(i) == left_out) continue;
    auto* functor = new PanTiltResidual{samples[i].angles, Eigen::Quaterniond(samples[i].T_world_camera.linear()),
                                        samples[i].T_world_camera.translation(), 1 / state.sigma_rad,
                                        turns_only ? 0 : 1 / state.sigma_m};
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PanTiltResidual, 6, 7, 2, 7, 4>(functor),
                             state.robust ? new ceres::CauchyLoss(kRobust) : nullptr, state.world.data(),
                             state.link.data(), state.camera.data(), state.joints.data());
  }
  problem.SetManifold(state.world.data(), motion_manifold());
  problem.SetManifold(state.camera.data(), motion_manifold());
  if (state.held_joints.size() == 4)
    problem.SetParameterBlockConstant(state.joints.data());
  else if (!state.held_joints.empty())
    problem.SetManifold(state.joints.data(), new ceres::SubsetManifold(4, state.held_joints));
}

// The 24 turns that map the axes of a cube onto each other.
std::vector<Eigen::Quaterniond> cube_turns() {
  std::vector<Eigen::Quaterniond> turns;
  const double quarter = 1.5707963267948966;
  for (int spin = 0; spin < 4; ++spin) {
    const Eigen::Quaterniond about_z(Eigen::AngleAxisd(spin * quarter, Eigen::Vector3d::UnitZ()));
    for (int i = 0; i < 4; ++i)
      turns.push_back(Eigen::Quaterniond(Eigen::AngleAxisd(i * quarter, Eigen::Vector3d::UnitX())) * about_z);
    for (const int i : {1, 3})
      turns.push_back(Eigen::Quaterniond(Eigen::AngleAxisd(i * quarter, Eigen::Vector3d::UnitY())) * about_z);
  }
  return turns;
}

double turn_cost(const std::vector<PanTiltSample>& samples, const PanTiltState& state) {
  const PanTiltModel model = to_model(state);
  double sum = 0;
  for (const PanTiltSample& sample : samples) {
    const Eigen::Quaterniond predicted(camera_pose(model, sample.angles).linear());
    sum += std::pow(predicted.angularDistance(Eigen::Quaterniond(sample.T_world_camera.linear())), 2);
  }
  return sum;
}

void set_turn(MotionParameters& motion, const Eigen::Quaterniond& q) {
  motion[0] = q.x(), motion[1] = q.y(), motion[2] = q.z(), motion[3] = q.w();
}

}  // namespace

PanTiltModel to_model(const PanTiltState& state) {
  PanTiltModel model;
  model.T_world_pan = to_pose(state.world);
  model.length_m = state.link[0], model.twist_rad = state.link[1];
  model.T_tilt_camera = to_pose(state.camera);
  model.gain = {state.joints[0], state.joints[1]};
  model.backlash_rad = {state.joints[2], state.joints[3]};
  return model;
}

double fit_pan_tilt(const std::vector<PanTiltSample>& samples, PanTiltState& state, int left_out, bool turns_only) {
  ceres::Problem problem;
  build(samples, state, left_out, turns_only, problem);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable())
    throw RuntimeFailure("the pan-tilt fit does not converge (" + summary.message + ")",
                         "check that the angles belong to the poses");
  return summary.final_cost;
}

double start_pan_tilt(const std::vector<PanTiltSample>& samples, PanTiltState& state) {
  std::vector<PanTiltSample> some;
  const std::size_t count = std::min(samples.size(), kStartSamples);
  for (std::size_t i = 0; i < count; ++i) some.push_back(samples[i * samples.size() / count]);
  std::vector<std::pair<double, PanTiltState>> starts;
  const std::vector<Eigen::Quaterniond> turns = cube_turns();
  for (const Eigen::Quaterniond& world : turns) {
    for (const Eigen::Quaterniond& camera : turns) {
      PanTiltState trial = state;
      set_turn(trial.world, world), set_turn(trial.camera, camera);
      starts.emplace_back(turn_cost(some, trial), trial);
    }
  }
  std::stable_sort(starts.begin(), starts.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  double least = 1e300;
  for (std::size_t i = 0; i < std::min(kStarts, starts.size()); ++i) {
    PanTiltState trial = starts[i].second;
    const double cost = fit_pan_tilt(some, trial, -1, true);
    if (cost < least) least = cost, state = trial;
  }
  return fit_pan_tilt(samples, state) / static_cast<double>(samples.size());
}

Eigen::MatrixXd pan_tilt_covariance(const std::vector<PanTiltSample>& samples, PanTiltState& state, int& open) {
  ceres::Problem problem;
  const bool robust = std::exchange(state.robust, false);  // the loss would count good poses as less than they say
  build(samples, state, -1, false, problem);
  state.robust = robust;
  std::vector<double*> shared{state.world.data(), state.link.data(), state.camera.data()};
  if (state.held_joints.size() < 4) shared.push_back(state.joints.data());
  ArrowSystem system = arrow_system(problem, shared, {});
  open = static_cast<int>(system.open.size());
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(system.shared_covariance.rows());
  scale.segment<3>(0).setConstant(2);  // the manifold of a rotation steps by half angles
  scale.segment<3>(8).setConstant(2);
  return scale.asDiagonal() * system.shared_covariance * scale.asDiagonal();
}

}  // namespace foresight
