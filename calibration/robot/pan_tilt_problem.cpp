#include "calibration/robot/pan_tilt_problem.hpp"

#include <ceres/autodiff_cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/rotation.h>

#include <algorithm>
#include <utility>

#include "calibration/camera/minimise.hpp"
#include "calibration/robot/arrow_system.hpp"
#include "common/error.hpp"
#include "common/rotation.hpp"

namespace foresight {
namespace {

constexpr double kRobust = 3;
constexpr double kLeastSweep = 0.05, kLeastOffTheLine = 0.01;  // rad
constexpr std::size_t kStartSamples = 40, kStarts = 30;

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
    const HeadMotion<T> head = head_motion(world, link, camera, pan, tilt);
    const Quaternion off = head.q.conjugate() * q_measured.cast<T>();
    const T wxyz[4] = {off.w(), off.x(), off.y(), off.z()};
    ceres::QuaternionToAngleAxis(wxyz, residual);
    const Vector shift = head.q.conjugate() * Vector(p_measured.cast<T>() - head.p);
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
  hold_joints(state, problem);
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

double sweep(const std::vector<PanTiltAngles>& angles, double PanTiltAngles::*joint) {
  double low = 1e300, high = -1e300;
  for (const PanTiltAngles& a : angles) low = std::min(low, a.*joint), high = std::max(high, a.*joint);
  return angles.empty() ? 0 : high - low;
}

/// Standard deviation across the line that the angles lie nearest to.
double off_the_line(const std::vector<PanTiltAngles>& angles) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const PanTiltAngles& a : angles) mean += Eigen::Vector2d(a.pan, a.tilt) / static_cast<double>(angles.size());
  for (const PanTiltAngles& a : angles) {
    const Eigen::Vector2d d = Eigen::Vector2d(a.pan, a.tilt) - mean;
    spread += d * d.transpose() / static_cast<double>(angles.size());
  }
  return principal_lengths(spread)[1];
}

}  // namespace

void hold_joints(PanTiltState& state, ceres::Problem& problem) {
  problem.SetManifold(state.world.data(), motion_manifold());
  problem.SetManifold(state.camera.data(), motion_manifold());
  if (state.held_joints.size() == 4)
    problem.SetParameterBlockConstant(state.joints.data());
  else if (!state.held_joints.empty())
    problem.SetManifold(state.joints.data(), new ceres::SubsetManifold(4, state.held_joints));
}

void require_sweeps(const std::vector<PanTiltAngles>& angles) {
  const bool pan = sweep(angles, &PanTiltAngles::pan) > kLeastSweep,
             tilt = sweep(angles, &PanTiltAngles::tilt) > kLeastSweep;
  if (!pan && !tilt) throw InputError("--angles", "neither joint moved", "sweep both joints");
  const std::string still = pan ? "tilt" : "pan";
  if (!pan || !tilt)
    throw InputError("--angles",
                     "only the " + std::string(pan ? "pan" : "tilt") +
                         " joint moved; 4 of 14 parameters stay open: how the " + still +
                         " axis points (2) and where it lies (2)",
                     "add poses at other " + still + " angles");
  if (off_the_line(angles) < kLeastOffTheLine)
    throw InputError("--angles", "pan and tilt moved together only, so that nothing tells one joint from the other",
                     "sweep each joint at several angles of the other");
}

void choose_joints(const std::vector<PanTiltAngles>& angles, bool gains, bool backlash, PanTiltState& state,
                   std::vector<std::string>& notes) {
  state.held_joints.clear();
  if (!gains) state.held_joints = {0, 1};
  for (int joint = 0; joint < 2; ++joint) {
    int up = 0, down = 0;
    for (const PanTiltAngles& a : angles) {
      up += a.came[static_cast<std::size_t>(joint)] > 0;
      down += a.came[static_cast<std::size_t>(joint)] < 0;
    }
    if (backlash && up >= 3 && down >= 3) continue;
    state.held_joints.push_back(2 + joint);
    if (backlash && up + down > 0)
      notes.push_back(std::string(joint == 0 ? "pan" : "tilt") +
                      " backlash stays open: come to 3 poses and more from " + (up < 3 ? "below" : "above") + " too");
  }
}

std::vector<std::string> pan_tilt_names(const PanTiltState& state) {
  std::vector<std::string> names;
  for (const char* frame : {"world_pan", "tilt_camera"}) {
    for (const char* part : {"rx", "ry", "rz"}) names.push_back(frame + std::string("_") + part + "_rad");
    for (const char* part : {"x", "y", "z"}) names.push_back(frame + std::string("_") + part + "_m");
    if (names.size() == 6) names.insert(names.end(), {"length_m", "twist_rad"});
  }
  const char* kJoints[] = {"gain_pan", "gain_tilt", "backlash_pan_rad", "backlash_tilt_rad"};
  for (int i = 0; i < 4; ++i)
    if (std::find(state.held_joints.begin(), state.held_joints.end(), i) == state.held_joints.end())
      names.emplace_back(kJoints[i]);
  return names;
}

Eigen::VectorXd pan_tilt_tangent_scale(Eigen::Index size) {
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(size);
  scale.segment<3>(0).setConstant(2);
  scale.segment<3>(8).setConstant(2);
  return scale;
}

PanTiltState to_state(const PanTiltModel& model) {
  PanTiltState state;
  state.world = to_parameters(model.T_world_pan);
  state.link = {model.length_m, model.twist_rad};
  state.camera = to_parameters(model.T_tilt_camera);
  state.joints = {model.gain[0], model.gain[1], model.backlash_rad[0], model.backlash_rad[1]};
  return state;
}

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
  MinimiseOptions options;
  options.solver = ceres::DENSE_NORMAL_CHOLESKY;
  return minimise_or_throw(problem, options, "the pan-tilt fit", "check that the angles belong to the poses");
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
  const Eigen::VectorXd scale = pan_tilt_tangent_scale(system.shared_covariance.rows());
  return scale.asDiagonal() * system.shared_covariance * scale.asDiagonal();
}

}  // namespace foresight
